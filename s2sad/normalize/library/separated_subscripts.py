"""separated_subscripts: subscripts that pick elements on both sides of a slice, as subscripts that all do.

    a[i, :, places]     ->      a[i, np.arange(a.shape[1])[None, :], places[:, None]]

NumPy puts the axes of what they pick first, those of the slices behind them. Used by `typed_rewrites`.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.infer.slice_extents import are_separated
from s2sad.tree import (
    AST, Attribute, Constant, List, Name, Slice, Subscript, at, attribute, call, const, copy, index, indices, tuple_of,
)


def separated_subscripts(node: Subscript, typing: Typing) -> Subscript | None:
    """The subscript without slices between what picks, None of any other one."""
    kind, given = typing.of(node.value), indices(node)
    if not kind.is_array or not are_separated(given, typing) or not _is_named(node.value):
        return None
    subscripts = _spelled_out(given, kind.rank, typing)
    between = [k for k, s in enumerate(subscripts) if _is_between(s)]
    made: list[AST] = []
    axis = 0
    for k, s in enumerate(subscripts):
        if isinstance(s, Slice):
            place = between.index(k)
            size = index(attribute(copy(node.value), "shape"), const(axis))
            made.append(index(call("numpy.arange", size), s) if s.lower or s.upper or s.step else call(
                "numpy.arange", size))
            made[-1] = _spread(made[-1], place, 1, len(between) - place - 1)
        elif not _is_between(s):
            rank = typing.of(s).rank
            made.append(_spread(s, 0, rank, len(between)) if rank else s)
        axis += not (isinstance(s, Constant) and s.value is None)
    return at(Subscript(node.value, tuple_of(*made), node.ctx), node)


def _is_named(base: AST) -> bool:
    """Whether asking for the size of an array computes nothing."""
    return isinstance(base, Name) or isinstance(base, Subscript) and _is_named(base.value) and not any(
        isinstance(s, (Subscript, Attribute)) for s in indices(base))


def _is_between(subscript: AST) -> bool:
    return isinstance(subscript, Slice) or isinstance(subscript, Constant) and subscript.value is None


def _spelled_out(given: list[AST], rank: int, typing: Typing) -> list[AST]:
    """The subscripts with a slice for each axis that has none, and with places where masks pick."""
    found: list[AST] = []
    taken = sum(typing.of(s).rank if _is_mask(s, typing) else not (isinstance(s, Constant) and s.value in (None, ...))
                for s in given)
    left = [Slice(None, None, None) for _ in range(rank - taken)]
    for s in given:
        if isinstance(s, Constant) and s.value is ...:
            found, left = [*found, *left], []
        elif _is_mask(s, typing):
            found += [call("numpy.nonzero", copy(s), part=const(k)) for k in range(typing.of(s).rank)]
        else:
            found.append(at(call("numpy.array", s), s) if isinstance(s, List) else s)
    return [*found, *left]


def _is_mask(subscript: AST, typing: Typing) -> bool:
    if isinstance(subscript, (Slice, Constant)):
        return False
    kind = typing.of(subscript)
    return kind.is_array and kind.dtype == "bool"


def _spread(array: AST, before: int, rank: int, behind: int) -> AST:
    """An array with new axes around its own."""
    if not before and not behind:
        return array
    whole = Slice(None, None, None)
    return at(index(array, *(const(None) for _ in range(before)), *(copy(whole) for _ in range(rank)),
                    *(const(None) for _ in range(behind))), array)
