"""store_hazards: whether a whole-array statement reads cells of what it fills that another of its cells fills.

    x[1:] = x[:-1]                  they do: NumPy reads all of the right side first, a loop must, too
    x[0, :] = x[-2, :]              they do not: each cell reads its own column
    x[1:] -= c * x[1:]              nor here: each cell reads itself
"""
from __future__ import annotations

from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import Shapes
from s2sad.normalize.loops.element_of import moves
from s2sad.tree import AST, Constant, Name, Slice, Subscript, children, dump, indices, walk


def overlaps(target: Subscript, value: AST, typing: Typing) -> bool:
    """Whether filling the target cell by cell could read a cell that was filled before."""
    base = base_name(target)
    if any(typing.of(s).is_array for s in indices(target) if not isinstance(s, Slice)):
        return any(_reads_other(n, target, typing) for n in walk(value))
    if moves(value):
        return any(base_name(a) == base for a in getattr(value, "args", []))
    if isinstance(value, (Name, Subscript)):
        return base_name(value) == base and typing.of(value).is_array and not _aligned(target, value, typing)
    return any(overlaps(target, child, typing) for child in children(value))


def _reads_other(node: AST, target: Subscript, typing: Typing) -> bool:
    """Whether a node reads the array of which a target picks elements, other than those; an array of integers may pick
    one twice."""
    if not isinstance(node, (Name, Subscript)) or base_name(node) != base_name(target) or not typing.of(node).is_array:
        return False
    masked = any(typing.of(s).dtype == "bool" for s in indices(target) if not isinstance(s, Slice))
    return not masked or isinstance(node, Subscript) and dump(node) != dump(target)


def _aligned(target: Subscript, load: AST, typing: Typing) -> bool:
    """Whether two cells of the target that differ never read and fill the same cell: along each axis that is walked
    the load is at the same index."""
    rank = typing.of(target.value).rank
    shapes = Shapes(typing, {})
    ours = shapes.full(indices(target), rank)
    theirs = shapes.full(indices(load) if isinstance(load, Subscript) else [], rank)
    walked = _walked(theirs, typing.of(target).rank)
    return all(_same(ours[axis], walked.get(number)) and walked.get(number, (None, -1))[1] == axis
               for number, axis in enumerate(k for k, s in enumerate(ours) if isinstance(s, Slice)))


def _walked(subscripts: list[AST], rank: int) -> dict[int, tuple[AST, int]]:
    """The slice and the axis of the array by the axis of the result."""
    axis, parts = 0, []
    for subscript in subscripts:
        new = isinstance(subscript, Constant) and subscript.value is None
        if new or isinstance(subscript, Slice):
            parts.append((subscript, -1 if new else axis))
        axis += not new
    return {rank - len(parts) + k: part for k, part in enumerate(parts)}


def _same(ours: AST, theirs: tuple[AST, int] | None) -> bool:
    return theirs is not None and dump(ours) == dump(theirs[0])
