"""requested_shapes: the shapes that allocations and `np.reshape` request by their arguments.

Requires types. A size of -1 is the remainder of the elements, whatever its form; `may_be_remainder` has those that may
be -1.

    (-1, n)     w.shape[:1] + (-1,)     k = -1; (k, n)      SH, which is (-1, 4) in the module
"""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.infer.affine import Affine
from s2sad.infer.signatures.laws import ONE, Shape, whole_number
from s2sad.infer.slice_extents import SliceExtents
from s2sad.tree import (
    AST, Add, Attribute, BinOp, FloorDiv, List, Mod, Mult, Name, Subscript, Tuple, call_name, const, copy, dump,
    equal, index,
)

_COUNTS = ("builtins.len", "numpy.size", "numpy.count_nonzero", "builtins.abs")
_REMAINDER = Affine((), -1)


class RequestedShapes(SliceExtents):
    """The shapes that arguments in one function request."""

    def requested(self, shape: AST, old: Shape | None = None) -> Shape | None:
        """The shape that an argument requests; in a reshape of `old` a size of -1 is the remainder of the elements."""
        if isinstance(shape, Attribute) and shape.attr == "shape":
            return self.of(shape.value)
        parts = self.size_nodes(shape)
        if parts is None:
            return None
        found = [self.length(p) for p in parts]
        for k, part in enumerate(parts):
            if old is not None and self.is_remainder(part):
                others = [d for j, d in enumerate(found) if j != k]
                found[k] = None if None in others or None in old else self._rest(old, others)
        return tuple(found)

    def size_nodes(self, shape: AST) -> list[AST] | None:
        """The expressions of the sizes in an argument; None if they are not known."""
        if isinstance(shape, (Tuple, List)):
            return list(shape.elts)
        if isinstance(shape, Attribute) and shape.attr == "shape" and self.typing.of(shape.value).is_array:
            return [index(copy(shape), const(k)) for k in range(self.typing.of(shape.value).rank)]
        if isinstance(shape, BinOp) and isinstance(shape.op, Add) and self.typing.of(shape).kind == "tuple":
            left, right = self.size_nodes(shape.left), self.size_nodes(shape.right)
            return None if left is None or right is None else left + right
        if self.typing.of(shape).kind != "tuple":
            return [shape]
        value = self._constant(shape)
        if isinstance(value, (tuple, list)):
            return [index(copy(shape), const(k)) for k in range(len(value))]
        bound = self.values.get(shape.id) if isinstance(shape, Name) else None
        return None if bound is None else self.size_nodes(bound)

    def is_remainder(self, part: AST) -> bool:
        """Whether a size is -1."""
        return self._constant(part) == -1 or self.size(part) == _REMAINDER

    def may_be_remainder(self, shape: AST) -> list[AST]:
        """The sizes in an argument of a reshape that may be -1; NumPy refuses two of them."""
        parts = self.size_nodes(shape) or []
        texts = [dump(p) for p in parts]
        if any(map(self.is_remainder, parts)):
            return []
        return [p for p, text in zip(parts, texts) if texts.count(text) == 1 and not self.never_negative(p)]

    def never_negative(self, node: AST) -> bool:
        """Whether an integer expression is known not to be negative: made of sizes, counters and constants."""
        value = self._constant(node)
        if type(value) is int:
            return value >= 0
        if isinstance(node, BinOp) and isinstance(node.op, (Add, Mult, FloorDiv)):
            return self.never_negative(node.left) and self.never_negative(node.right) or self.is_counted(node)
        if isinstance(node, BinOp) and isinstance(node.op, Mod):
            return self.never_negative(node.right)
        called = call_name(node)
        if called in ("builtins.max", "builtins.min") and len(node.args) > 1:
            return (any if called == "builtins.max" else all)(map(self.never_negative, node.args))
        bound = self.values.get(node.id) if isinstance(node, Name) else None
        return (isinstance(node, Attribute) and node.attr in ("size", "ndim") or called in _COUNTS
                or _is_extent(node) or self.is_counted(node) or bound is not None and self.never_negative(bound))

    def _constant(self, node: AST) -> object:
        """The value of a name of the module, or of an item of a tuple of numbers there."""
        if isinstance(node, Subscript):
            whole, number = self._constant(node.value), whole_number(node.slice)
            if number is None or not isinstance(whole, (tuple, list)) or not -len(whole) <= number < len(whole):
                return None
            return whole[number]
        if isinstance(node, Name) and node.id.startswith("const."):
            return self.typing.constants.get(node.id.removeprefix("const."))
        return None

    def length(self, node: AST) -> Affine | None:
        """The size that an argument requests; of `max(n - 2, 0)` it is the extent n - 2, as of a slice."""
        clipped = call_name(node) == "builtins.max" and len(node.args) == 2 and whole_number(node.args[1]) == 0
        inner = node.args[0] if clipped else node
        extent = self.axis_size(inner)
        return self.size(inner) if extent is None else extent

    def _rest(self, old: Shape, others: list[Affine | None]) -> Affine | None:
        """The remaining size of a reshape of `old` to the other sizes."""
        above, below = _without_common(old, others)
        if not below and len(above) <= 1:
            return above[0] if above else ONE
        made = self._product(above)
        return self.symbol(BinOp(made, FloorDiv(), self._product(below)) if below else made)

    def numbers_of_elements(self, old: Shape, new: Shape) -> tuple[AST, AST] | None:
        """The numbers of elements of two shapes, without the factors of both; None if there are no others, or one is
        not known."""
        if None in old or None in new:
            return None
        above, below = _without_common(old, new)
        both = self._product(above), self._product(below)
        return None if equal(*both) else both

    def _product(self, sizes: list[Affine]) -> AST:
        if not sizes:
            return const(1)
        made = self.expression(sizes[0])
        for size in sizes[1:]:
            made = BinOp(made, Mult(), self.expression(size))
        return made


def _without_common(old: Sequence[Affine | None], new: Sequence[Affine | None]) -> tuple[list[Affine], list[Affine]]:
    """The sizes of two shapes without those that both have."""
    above = [d for d in old if d is not None and d != ONE]
    below = [d for d in new if d is not None and d != ONE]
    for size in list(below):
        if size in above:
            above.remove(size)
            below.remove(size)
    return above, below


def _is_extent(node: AST) -> bool:
    return isinstance(node, Subscript) and isinstance(node.value, Attribute) and node.value.attr == "shape"
