"""element_of: one element of a whole-array expression, by its position.

    u[1:-1] + c * v[:, None]        at i, j     u[i + 1, j] + c * v[i]
    np.roll(u, 1, axis=0)           at i, j     u[(i - 1) % u.shape[0], j]
"""
from __future__ import annotations

from collections.abc import Callable, Mapping

from s2sad import rules
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import ONE
from s2sad.infer.shapes import Shapes
from s2sad.infer.slice_extents import is_step, step_expression
from s2sad.normalize.buffers.compose_subscripts import is_new
from s2sad.normalize.library.element_moves import SOURCES
from s2sad.tree import (
    AST, Attribute, BinOp, Call, FloorDiv, Mod, Name, Slice, Subscript, add, call_name, const, copy, index, indices,
    mult, name, rebuild,
)


class Elements:
    """Elements of the expressions of one function; positions are integer expressions, one for each axis."""

    def __init__(self, typing: Typing, shapes: Shapes):
        self.typing, self.shapes = typing, shapes
        self.walked: dict[str, list[AST]] = {}  # the counters of the mask of the statement, by its name

    def element(self, node: AST, positions: list[AST]) -> AST:
        """The element of an expression at these positions; what is no array stays as it is."""
        def change(n: AST) -> AST | None:
            if not self.typing.of(n).is_array:
                asked = isinstance(n, (Subscript, Attribute, Name)) or call_name(n) == "builtins.len"
                return copy(n) if asked else None
            if isinstance(n, Name):
                return self.load(n, [Slice(None, None, None)] * self.typing.of(n).rank, positions)
            if isinstance(n, Subscript):
                return self.load(n.value, self.shapes.full(indices(n), self.typing.of(n.value).rank), positions)
            moved = _ELEMENTS.get(call_name(n) or "")
            return moved(self, n, positions) if moved else None
        return rebuild(node, change)

    def load(self, base: AST, subscripts: list[AST], positions: list[AST]) -> AST:
        """The element of a part of an array."""
        assert isinstance(base, Name)
        arrays = [k for s in subscripts if not isinstance(s, Slice) and (k := self.typing.of(s)).is_array]
        masked = any(a.dtype == "bool" for a in arrays)
        picked = 0 if not arrays else 1 if masked else max(a.rank for a in arrays)
        waiting = positions[len(positions) - picked - sum(isinstance(s, Slice) or is_new(s) for s in subscripts):]
        held: list[AST] | None = None
        made: list[AST] = []
        for subscript in subscripts:
            if is_new(subscript):
                waiting = waiting[1:]
            elif not isinstance(subscript, Slice) and (kind := self.typing.of(subscript)).is_array:
                if held is None:
                    held, waiting = waiting[:picked], waiting[picked:]
                made += map(copy, self.walked[subscript.id]) if masked else [
                    self.element(subscript, held[picked - kind.rank:])]
            elif isinstance(subscript, Slice):
                made.append(self.cell(base.id, len(made), subscript, waiting[0]))
                waiting = waiting[1:]
            else:
                made.append(copy(subscript))
        return index(name(base.id), *made)

    def cell(self, base: str, axis: int, part: Slice, position: AST) -> AST:
        """The index on one axis of the element at a position of a slice; of a single one whatever the position."""
        size = self.shapes.own_symbol(base, axis)
        shapes = self.shapes.for_slice(part, size)
        span = shapes.span(part, size)
        assert span is not None, "the bounds of a slice are names and numbers"
        start, _, step = span
        if shapes.sliced(part, shapes.of(name(base))[axis]) == ONE:
            return self.shapes.expression(start, reduced=False)
        form = self.shapes.size(position)
        if form is None:
            moved = position if is_step(step, 1) else mult(position, step_expression(step))
            return copy(moved) if not start.terms and not start.constant else add(
                self.shapes.expression(start, reduced=False), copy(moved))
        return self.shapes.expression(self.shapes.position_after(self.shapes.reduced(start), form, step))

    def size_of(self, node: AST, axis: int) -> AST:
        """The size of an axis of an array or a part of one."""
        if isinstance(node, Name):
            return self.shapes.expression(self.shapes.own_symbol(node.id, axis), reduced=False)
        size = self.shapes.of(node)[axis]
        assert size is not None
        return self.shapes.expression(size)


# -- functions of arrays whose elements are those of their operands -------------------------------------------------

def _moved(elements: Elements, node: AST, positions: list[AST]) -> AST:
    rule = rules.find_array(call_name(node))
    assert rule is not None and isinstance(node, Call)
    options = rule.arguments(node)
    x = options["x"]
    return elements.element(x, SOURCES[rule.name](options, positions, lambda axis: elements.size_of(x, axis)))


def _outer(elements: Elements, node: AST, positions: list[AST]) -> AST:
    a, b = node.args
    return mult(elements.element(a, positions[:1]), elements.element(b, positions[1:]))


def _reshape(elements: Elements, node: AST, positions: list[AST]) -> AST:
    """By way of the number of an element in row-major order, where axes are not the same at either end."""
    x = node.args[0]
    kept = [(p, s) for p, s in zip(positions, elements.shapes.of(node)) if s != ONE]
    inner = [(k, s) for k, s in enumerate(elements.shapes.of(x)) if s != ONE]
    moved: list[AST] = [const(0)] * elements.typing.of(x).rank
    for end in (-1, 0):
        while kept and inner and (len(kept) == len(inner) == 1 or kept[end][1] == inner[end][1] is not None):
            moved[inner.pop(end)[0]] = kept.pop(end)[0]
    number = kept[0][0] if kept else const(0)
    for position, size in kept[1:]:
        assert size is not None
        number = add(mult(number, elements.shapes.expression(size)), position)
    for k, _ in reversed(inner):
        moved[k] = number if k == inner[0][0] else BinOp(copy(number), Mod(), elements.size_of(x, k))
        number = BinOp(number, FloorDiv(), elements.size_of(x, k))
    return elements.element(x, moved)


_ELEMENTS: Mapping[str, Callable[[Elements, AST, list[AST]], AST]] = {
    **dict.fromkeys(SOURCES, _moved), "numpy.reshape": _reshape, "numpy.ravel": _reshape, "numpy.outer": _outer,
}


def moves(node: AST) -> bool:
    """Whether each element of a call is one element of an operand, or a product of two."""
    return call_name(node) in _ELEMENTS
