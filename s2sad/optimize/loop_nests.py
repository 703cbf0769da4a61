"""loop_nests: perfect nests of counted loops with loop-free bodies, for transformations of several loops.

    for i in range(1, n):
        for j in range(m):      counters i, j; starts 1, 0; trip counts n - 1 and m
            a[i, j] = 0.0
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.infer.affine import Affine
from s2sad.optimize.loop_bounds import counted_loop, is_loop_free
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.tree import AST, For, at, names


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
