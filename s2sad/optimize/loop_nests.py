"""loop_nests: perfect nests of counted loops with loop-free bodies, and passes over all loops of a function.

    for i in range(1, n):
        for j in range(m):      counters i, j; starts 1, 0; trip counts n - 1 and m
            a[i, j] = 0.0
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Set
from dataclasses import dataclass

from s2sad.blocks import with_blocks
from s2sad.infer.affine import Affine
from s2sad.optimize.loop_bounds import counted_loop, is_loop_free, least_value
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.tree import AST, Assign, For, at, names, stored_names


@dataclass
class Nest:
    """A perfect loop nest: its loops, their starts and trip counts, and the innermost body."""
    loops: list[For]
    starts: list[Affine]
    trip_counts: list[Affine]
    body: list[AST]

    @property
    def counters(self) -> list[str]:
        return [loop.target.id for loop in self.loops]

    @property
    def bounds(self) -> set[str]:
        """The names in the bounds of the loops."""
        return {n for loop in self.loops for n in names(loop.iter)}

    def with_body(self, body: list[AST]) -> For:
        for loop in reversed(self.loops):
            body = [at(For(loop.target, loop.iter, body, [], None), loop)]
        return body[0]


def perfect_nest(statement: AST, extents: IterationSpaces) -> Nest | None:
    """The nest that a statement is, None if it is no such nest."""
    found = Nest([], [], [], [statement])
    while len(found.body) == 1 and isinstance(loop := found.body[0], For):
        bounds = counted_loop(loop)
        if bounds is None or bounds.step < 0 or {*found.counters} & set(names(loop.iter)):
            return None
        start, stop = extents.form(bounds.start), extents.form(bounds.stop, clipped=True)
        if start is None or stop is None or start.terms or start.constant < 0:
            return None
        found.loops.append(loop)
        found.starts.append(start)
        found.trip_counts.append(stop.plus(start, -1))
        found.body = loop.body
    return found if found.loops and is_loop_free(found.body, extents.writing) else None


class LoopPass(ABC):
    """A pass over the loops of a function, which allocates what it needs before the loops that do not bind its size."""

    def __init__(self) -> None:
        self.hoisted: list[Assign] = []     # allocations on their way out of the loops

    @abstractmethod
    def statement(self, statement: AST, least: Mapping[str, int]) -> list[AST]:
        """What takes the place of a statement; `least` are lower bounds of the counters around it."""

    def block(self, block: list[AST], least: Mapping[str, int], bound: Set[str] | None) -> list[AST]:
        """A block, in a statement that binds these names; None where there is none around it."""
        made: list[AST] = []
        for statement in block:
            new = self.statement(statement, least)
            made += [s for s in self.hoisted if bound is None or bound & set(names(s.value))]
            self.hoisted = [s for s in self.hoisted if not any(s is m for m in made)]
            made += new
        return made

    def with_inner_blocks(self, statement: AST, least: Mapping[str, int]) -> AST:
        """A statement with its blocks transformed."""
        inside, bound = least_inside(statement, least), set(stored_names(statement))
        return with_blocks(statement, lambda block: self.block(block, inside, bound))


def least_inside(statement: AST, least: Mapping[str, int]) -> dict[str, int]:
    """The lower bounds of the counters around the blocks of a statement, given those around it."""
    inside = dict(least)
    if isinstance(statement, For):
        inside.pop(statement.target.id, None)
        ends = bounds.ends() if (bounds := counted_loop(statement)) else None
        first = least_value(ends[0], least) if ends else None
        inside |= {statement.target.id: first} if first is not None else {}
    return inside
