"""layouts: how the arrays and numbers of many directions lie, and how those of one are spelled.

    x_dot[i, j]     x_dot[i, j, b]      Interleaved, for Numba: one more axis, the innermost, so that a loop over
    t_dot           t_dot[b]            directions runs in vectors; a number is an array of the width
    x_dot[i, j]     x_dot[b][i, j]      Apart, for NumPy: a list of arrays and numbers, whatever their shapes
    t_dot           t_dot[b]
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.types import Type
from s2sad.tree import (
    AST, Constant, Name, Slice, Subscript, Tuple, attribute, binary, call, const, copy, index, indices, name, tuple_of,
    Add,
)

# numbers of single precision are held in double precision, as Numba does where they begin with a constant
_DTYPES = {"float64": None, "float32": None, "bool": "numpy.bool_", "complex64": "numpy.complex128"}


def is_ellipsis(node: AST) -> bool:
    return isinstance(node, Constant) and node.value is Ellipsis


class Layout:
    """What both layouts have; `kinds` are the types of the names for one direction."""

    def __init__(self, kinds: Mapping[str, Type]):
        self.kinds = kinds

    def is_number(self, identifier: str) -> bool:
        kind = self.kinds.get(identifier)
        return kind is not None and kind.is_number


class Apart(Layout):
    """Lists by direction."""
    in_place = False

    def named(self, identifier: str, b: AST) -> AST:
        """What a name holds for a direction."""
        return index(name(identifier), b)

    def part(self, base: str, places: AST, b: AST) -> AST:
        """A part of it."""
        return index(self.named(base, b), places)


class Interleaved(Layout):
    """Arrays with directions along the innermost axis, `width` of them."""
    in_place = True

    def __init__(self, kinds: Mapping[str, Type], width: int):
        super().__init__(kinds)
        self.width = width

    def named(self, identifier: str, b: AST) -> AST:
        """What a name holds for a direction."""
        return index(name(identifier), b) if self.is_number(identifier) else index(name(identifier), const(...), b)

    def part(self, base: str, places: AST, b: AST) -> AST:
        """A part of it."""
        found = list(places.elts) if isinstance(places, Tuple) else [places]
        if len(found) == 1 and is_ellipsis(found[0]):
            return self.named(base, b)
        return index(name(base), *found, b) if self.is_element(base, found) else index(self.named(base, b), places)

    def is_element(self, base: str, places: list[AST]) -> bool:
        """Whether subscripts pick one element of an array."""
        kind = self.kinds.get(base)
        return kind is not None and len(places) == kind.rank and all(map(self._is_integer, places))

    def _is_integer(self, place: AST) -> bool:
        if isinstance(place, Slice) or isinstance(place, Constant) and not isinstance(place.value, int):
            return False
        if isinstance(place, Name):
            kind = self.kinds.get(place.id)
            return kind is None or kind.is_number
        return not any(isinstance(n, Name) and (k := self.kinds.get(n.id)) is not None and k.is_array
                       for n in (place, *_bare_names(place)))

    def room(self, dtype: str) -> AST:
        """Memory for the numbers of all directions."""
        spelled = _DTYPES.get(dtype, f"numpy.{dtype}")
        return call("runtime.lanes", const(self.width), *([] if spelled is None else [name(spelled)]))

    def allocated(self, value: AST) -> AST | None:
        """An allocation for all directions in place of one for each; None if it is none."""
        called = getattr(getattr(value, "func", None), "id", "")
        if called in ("numpy.zeros_like", "numpy.empty_like") and not value.keywords and len(value.args) == 1:
            like = value.args[0]
            return call(called.removesuffix("_like"), binary(attribute(copy(like), "shape"), Add(), self._own()),
                        attribute(copy(like), "dtype"))
        if called not in ("numpy.zeros", "numpy.empty", "numpy.ones") or not value.args:
            return None
        made = copy(value)
        shape = value.args[0]
        is_tuple = isinstance(shape, Tuple)
        if is_tuple:
            made.args[0] = tuple_of(*map(copy, shape.elts), const(self.width))
        elif isinstance(shape, Name) and not self.is_number(shape.id) or getattr(shape, "attr", "") == "shape":
            made.args[0] = binary(copy(shape), Add(), self._own())
        else:
            made.args[0] = tuple_of(copy(shape), const(self.width))
        return made

    def _own(self) -> AST:
        return tuple_of(const(self.width))


def _bare_names(node: AST) -> list[AST]:
    """The names in an index that stand for themselves: neither a base of a subscript nor what a size is asked of."""
    if isinstance(node, Name):
        return [node]
    if isinstance(node, Subscript):
        return [n for i in indices(node) for n in _bare_names(i)]
    if hasattr(node, "attr"):
        return []
    left, right = getattr(node, "left", None), getattr(node, "right", None)
    parts = [p for p in (left, right, getattr(node, "operand", None), *getattr(node, "args", [])) if p is not None]
    return [n for p in parts for n in _bare_names(p)]
