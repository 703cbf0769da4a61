"""faster: innermost loops of an adjoint in a form that a compiler turns into vector instructions.

`joined` makes one nest of neighbouring ones, `totals` sums in numbers. Where neighbouring iterations share elements of
a shadow: `distribute` adds to rows in loops of their own, `rotate`
holds the elements in names, `peel` lets the first and the last iteration run by themselves where the others then need
no test, and `restored` copies rows of the tape beforehand.

Requires a finished adjoint for Numba; establishes the same sums in the same order, but for the shadows of numbers in
such loops, whose gains come in any order (`runtime.added`): partial sums round less.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.analyze.liveness import base_name
from s2sad.simplify.bounds import Counted, changed, counted, is_straight, shifted_by, stores
from s2sad.simplify.joined import joined
from s2sad.simplify.peel import peeled
from s2sad.blocks import with_blocks
from s2sad.simplify.restored import restored
from s2sad.simplify.rotate import rotated
from s2sad.simplify.distribute import distributed
from s2sad.simplify.totals import totals
from s2sad.tree import (
    AST, Add, Assign, AugAssign, For, FunctionDef, Name, Sub, Subscript, assign, at, call, copy, dump, indices,
    name, names, negate, stored_names, walk, with_body,
)

CHANGES_ROUNDING = True

_LONGEST = 60


def faster(function: FunctionDef, types: Mapping[str, Type], stacks: Set[str], shadows: Set[str],
           sums: Set[str], writing: Set[str] = frozenset()) -> FunctionDef:
    """The adjoint with its loops transformed; `shadows` are those of arrays, `sums` those of numbers, `writing` the
    functions that write arrays."""
    free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(types))
    function = joined(function, sums, types, free, writing)
    faster = _Faster({s: types[s] for s in shadows}, free, stacks, sums, writing)
    return with_body(function, faster.block(function.body, {}, None))


class _Faster:
    def __init__(self, shadows: Mapping[str, Type], free: Names, stacks: Set[str], sums: Set[str],
                 writing: Set[str]):
        self.shadows, self.free, self.stacks, self.sums = shadows, free, stacks, set(sums)
        self.writing = writing
        self.waiting: list[Assign] = []     # allocations on their way out of the loops

    def block(self, block: list[AST], least: dict[str, int], bound: set[str] | None) -> list[AST]:
        """The block; `least` are lower bounds of the counters around it, `bound` the names that the statement around it
        binds, None if there is none."""
        made: list[AST] = []
        for statement in block:
            new = self.statement(statement, least)
            made += [s for s in self.waiting if bound is None or bound & set(names(s.value))]
            self.waiting = [s for s in self.waiting if not any(s is m for m in made)]
            made += new
        return made

    def statement(self, statement: AST, least: dict[str, int]) -> list[AST]:
        bounds = counted(statement)
        inside = dict(least)
        if isinstance(statement, For):
            inside.pop(statement.target.id, None)
        if bounds is not None and is_straight(statement.body, self.writing):
            return self.loop(statement, inside)
        ends = bounds.ends() if bounds else None
        if bounds and ends and not ends[0].terms:
            inside[bounds.counter] = ends[0].constant
        bound = set(stored_names(statement))
        return [with_blocks(statement, lambda inner: self.block(inner, inside, bound))]

    def loop(self, loop: For, least: Mapping[str, int]) -> list[AST]:
        """An innermost loop as it is, or with the elements that iterations share in names: then what stands in the way
        of vectors goes as well."""
        if sum(1 for s in walk(loop.body) if isinstance(s, (Assign, AugAssign))) > _LONGEST:
            return [loop]
        bounds = counted(loop)
        assert bounds is not None
        held = totals(loop, bounds, self.shadows, self.free)
        self.sums |= held.sums
        return held.around(self.vectors(held.loop, least), bounds)

    def vectors(self, loop: For, least: Mapping[str, int]) -> list[AST]:
        """The loops for a loop whose sums are numbers."""
        rows, rest = restored(loop, self.stacks)
        bounds = counted(rest)
        assert bounds is not None
        for before, middle, after in filter(None, (peeled(rest, bounds), ([], rest, []))):
            made = self.apart(middle, least)
            if made is not None:
                return [*rows, *before, *(self.reassociated(s) for s in made), *after]
        return [self.reassociated(loop) if _is_parallel(loop, bounds) else loop]

    def apart(self, loop: For, least: Mapping[str, int]) -> list[AST] | None:
        """The loops in which no iteration reads what another one stores, None if nothing has to be done or can be."""
        parts = distributed(loop, self.shadows, self.free)
        if parts is None:
            return rotated(loop, least, self.shadows, self.free)
        first, *rest = parts.loops
        assert isinstance(first, For)
        self.waiting += parts.allocations
        return [*(rotated(first, least, self.shadows, self.free) or [first]), *rest]

    def reassociated(self, statement: AST) -> AST:
        """The loops of a statement with the sums that nothing else in them reads added in any order."""
        if isinstance(statement, For):
            return at(For(statement.target, statement.iter, self.gained(statement.body), [], None), statement)
        return with_blocks(statement, lambda block: [self.reassociated(s) for s in block])

    def gained(self, body: list[AST]) -> list[AST]:
        gains = [s for s in body if isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub))
                 and isinstance(s.target, Name) and s.target.id in self.sums]
        mentions = [n.id for n in walk(body) if isinstance(n, Name)]
        alone = {s.target.id for s in gains if mentions.count(s.target.id) == sum(
            g.target.id == s.target.id for g in gains)}
        return [self.added(s) if any(s is g for g in gains) and s.target.id in alone else s for s in body]

    def added(self, gain: AugAssign) -> AST:
        value = copy(gain.value) if isinstance(gain.op, Add) else negate(copy(gain.value))
        return at(assign(gain.target.id, call("runtime.added", name(gain.target.id), value)), gain)


def _is_parallel(loop: For, bounds: Counted) -> bool:
    """Whether each array that a loop stores into is referred to by one subscript, along a row."""
    places = {base_name(t): t for t in stores(loop.body)}
    return all(shifted_by(indices(place)[-1], bounds.counter) is not None
               and not changed(loop.body) & set(names(place))
               and all(dump(n) == dump(place) for n in walk(loop.body)
                       if isinstance(n, Subscript) and base_name(n) == array)
               for array, place in places.items())


__all__ = ["faster"]
