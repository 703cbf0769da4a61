"""Parts of parts of arrays: what a subscript of a view is of the view's base.

    inner = u[1:-1, 1:-1]           inner[2:, 0]    is  u[3:-1, 1]
    row = u[i]                      row[None, ::2]  is  u[i, None, ::2]
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.affine import Affine
from s2sad.infer.signatures.laws import ONE, whole_number
from s2sad.infer.shapes import Shapes
from s2sad.infer.slice_extents import Step, is_step, is_whole, step_expression
from s2sad.tree import AST, Add, BinOp, Constant, Mult, Name, Slice, call, const, copy

Refuse = Callable[[str], None]


def composed(shapes: Shapes, base: Name, prefix: list[AST], added: list[AST], refuse: Refuse) -> list[AST]:
    """The subscripts of `base` for subscripts of its part `base[prefix]`."""
    rank = shapes.typing.of(base).rank
    sizes = shapes.of(base)
    entries = shapes.full(prefix, rank)
    left = shapes.full(added, sum(isinstance(e, Slice) or is_new(e) for e in entries))
    made: list[AST] = []
    axis = 0
    for entry in entries:
        if not (isinstance(entry, Slice) or is_new(entry)):
            made.append(entry)
            axis += 1
            continue
        while left and is_new(left[0]):
            made.append(left.pop(0))
        subscript = left.pop(0)
        if is_new(entry):
            made += [] if not isinstance(subscript, Slice) else [entry]
            continue
        made.append(_combined(shapes, entry, subscript, sizes[axis], refuse))
        axis += 1
    return made + left


def is_new(node: AST) -> bool:
    """Whether a subscript adds an axis."""
    return isinstance(node, Constant) and node.value is None


def _combined(shapes: Shapes, outer: AST, inner: AST, size: Affine | None, refuse: Refuse) -> AST:
    if is_whole(outer):
        return inner
    if is_whole(inner):
        return outer
    span = shapes.span(outer, size) if size is not None and isinstance(outer, Slice) else None
    if span is None:
        refuse("a part of a part of an array whose bounds change")
        return inner
    start, stop, step = span
    length = shapes.sliced(outer, size)
    if length is None:
        refuse("a part of a part of an array whose bounds change")
        return inner
    if not isinstance(inner, Slice):
        return _element(shapes, start, step, inner, length)
    within = shapes.span(inner, length)
    if within is None or size is None:
        refuse("a part of a part of an array whose bounds change")
        return inner
    computed = [b for b in (inner.lower, inner.upper) if b is not None and whole_number(b) is None]
    if computed and not shapes.is_place(length):
        shapes.required.append(length)      # `position` takes it for one
    if length == ONE and inner.lower is None and inner.upper is None:
        return outer
    first = shapes.position_after(start, within[0], step)
    if shapes.sliced(inner, length) == ONE and (shapes.is_place(first) or not first.plus(size, -1).terms):
        near = shapes.is_place(first)
        return Slice(_bound(shapes, first) if near else const(first.plus(size, -1).constant),
                     shapes.expression(first.shift(1)) if near else _bound(shapes, first.shift(1), size), None)
    both = _product(step, within[2])
    if both is None:
        refuse("a part of a part of an array whose step is not a written number")
        return inner
    if isinstance(both, int) and both < 0:
        last = shapes.position_after(start, within[1], step)
        _require_stop(shapes, inner, size.plus(last, -1).shift(-1))
        return Slice(_bound_down(shapes, first, size), _bound_down(shapes, last, size, True), const(both))
    last = shapes.position_after(start, within[1], step) if is_step(step, 1) or within[1] != length else stop
    if last.plus(size, -1).terms:
        _require_stop(shapes, inner, last)
    return Slice(_bound(shapes, first), _bound(shapes, last, size), None if is_step(both, 1) else step_expression(both))


def _require_stop(shapes: Shapes, part: Slice, room: Affine) -> None:
    """Asks for the guard that there is room before a stop that counts from the end of a part: beyond the array it would
    be at its other end."""
    if (whole_number(part.upper) or 0) < 0 and not shapes.is_place(room):
        shapes.required.append(room)


def _product(step: Step, other: Step) -> Step | None:
    """The step of a part of a part; None where one runs backwards and the other is no constant."""
    if isinstance(step, int) and isinstance(other, int):
        return step * other
    if any(isinstance(s, int) and s < 0 for s in (step, other)):
        return None
    return next((step_expression(a) for a, b in ((step, other), (other, step)) if is_step(b, 1)),
                BinOp(step_expression(step), Mult(), step_expression(other)))


def _element(shapes: Shapes, start: Affine, step: Step, inner: AST, length: Affine) -> AST:
    """The position of one element of a slice."""
    number = whole_number(inner)
    if number is not None and shapes.is_place(length.shift(-number - 1 if number >= 0 else number)):
        at = Affine((), number) if number >= 0 else length.shift(number)
        return shapes.expression(shapes.position_after(start, at, step))
    inner = call("runtime.element", copy(inner), shapes.expression(length))
    scaled = inner if is_step(step, 1) else BinOp(copy(inner), Mult(), step_expression(step))
    return add_to(scaled, shapes, start)


def add_to(node: AST, shapes: Shapes, offset: Affine) -> AST:
    """`node + offset`, with constants folded."""
    form = shapes.size(node)
    if offset.terms or form is None or not isinstance(node, (BinOp, Name)):
        return copy(node) if offset == Affine() else BinOp(shapes.expression(offset), Add(), copy(node))
    return shapes.expression(form.plus(offset)) if offset.constant else copy(node)


def _bound_down(shapes: Shapes, form: Affine, size: Affine, stops: bool = False) -> AST | None:
    """A position as a bound of a slice that runs backwards; what may be before the first element counts from the end,
    where NumPy takes it for what it is."""
    if stops and not form.terms and form.constant < 0:
        return None
    rest = form.plus(size, -1)
    if not stops and rest == Affine((), -1):
        return None
    return shapes.expression(form if shapes.is_place(form) and rest.terms else rest)


def _bound(shapes: Shapes, form: Affine, size: Affine | None = None) -> AST | None:
    """A position as a bound of a slice, as one would write it."""
    if size is not None:
        rest = form.plus(size, -1)
        if rest == Affine():
            return None
        if not rest.terms and rest.constant < 0:
            return const(rest.constant)
    elif form == Affine():
        return None
    return shapes.expression(form)
