"""faster: innermost loops of an adjoint in a form that a compiler turns into vector instructions.

Where neighbouring iterations share elements of a shadow: `rotate` holds these in names, `peel` lets the first and the
last iteration run by themselves where the others then need no test, and `restored` copies rows of the tape beforehand.

Requires a finished adjoint for Numba; establishes the same sums in the same order, but for the shadows of numbers in
such loops, whose gains come in any order (`runtime.added`): partial sums round less.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.bounds import counted, is_straight
from s2sad.simplify.peel import peeled
from s2sad.simplify.rebuild import with_blocks
from s2sad.simplify.restored import restored
from s2sad.simplify.rotate import rotated
from s2sad.tree import (
    AST, Add, Assign, AugAssign, For, FunctionDef, Name, Sub, assign, at, call, copy, name, negate, walk,
)

_LONGEST = 60


def faster(function: FunctionDef, types: Mapping[str, Type], stacks: Set[str], shadows: Set[str],
           sums: Set[str]) -> FunctionDef:
    """The adjoint with its loops transformed; `shadows` are those of arrays, `sums` those of numbers."""
    free = Names({n.id for n in walk(function) if isinstance(n, Name)} | set(types))
    new = copy(function)
    new.body = _Faster({s: types[s] for s in shadows}, free, stacks, sums).block(function.body, {})
    return new


class _Faster:
    def __init__(self, shadows: Mapping[str, Type], free: Names, stacks: Set[str], sums: Set[str]):
        self.shadows, self.free, self.stacks, self.sums = shadows, free, stacks, sums

    def block(self, block: list[AST], least: dict[str, int]) -> list[AST]:
        """The block; `least` are lower bounds of the counters around it."""
        made: list[AST] = []
        for statement in block:
            bounds = counted(statement)
            inside = dict(least)
            if isinstance(statement, For):
                inside.pop(statement.target.id, None)
            if bounds is not None and is_straight(statement.body):
                made += self.loop(statement, inside)
                continue
            ends = bounds.ends() if bounds else None
            if bounds and ends and not ends[0].terms:
                inside[bounds.counter] = ends[0].constant
            made.append(with_blocks(statement, lambda inner, inside=inside: self.block(inner, inside)))
        return made

    def loop(self, loop: For, least: Mapping[str, int]) -> list[AST]:
        """An innermost loop as it is, or with the elements that iterations share in names: then what stands in the way
        of vectors goes as well."""
        if sum(1 for s in walk(loop.body) if isinstance(s, (Assign, AugAssign))) > _LONGEST:
            return [loop]
        rows, rest = restored(loop, self.stacks)
        bounds = counted(rest)
        assert bounds is not None
        for before, middle, after in filter(None, (peeled(rest, bounds), ([], rest, []))):
            made = rotated(middle, least, self.shadows, self.free)
            if made is not None:
                return [*rows, *before, *(self.reassociated(s) for s in made), *after]
        return [loop]

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


__all__ = ["faster"]
