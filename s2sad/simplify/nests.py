"""nests: perfect nests of counted loops with straight bodies, for the transformations of several loops.

    for i in range(1, n):
        for j in range(m):      counters i, j; starts 1, 0; they run n - 1 and m times
            a[i, j] = 0.0
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.infer.affine import Affine
from s2sad.simplify.bounds import counted, is_straight
from s2sad.simplify.extents import Extents
from s2sad.tree import AST, For, at, names


@dataclass
class Nest:
    """A perfect nest of loops: the counters, where they start, how far they run, and what is done for each."""
    loops: list[For]
    starts: list[Affine]
    runs: list[Affine]
    body: list[AST]

    @property
    def counters(self) -> list[str]:
        return [loop.target.id for loop in self.loops]

    @property
    def bounds(self) -> set[str]:
        """The names in the bounds of the loops."""
        return {n for loop in self.loops for n in names(loop.iter)}

    def around(self, body: list[AST]) -> For:
        for loop in reversed(self.loops):
            body = [at(For(loop.target, loop.iter, body, [], None), loop)]
        return body[0]


def nest_of(statement: AST, extents: Extents) -> Nest | None:
    """The nest that a statement is, None if it is another one."""
    found = Nest([], [], [], [statement])
    while len(found.body) == 1 and isinstance(loop := found.body[0], For):
        bounds = counted(loop)
        if bounds is None or bounds.step < 0 or {*found.counters} & set(names(loop.iter)):
            return None
        start, stop = extents.form(bounds.start), extents.form(bounds.stop, clipped=True)
        if start is None or stop is None or start.terms or start.constant < 0:
            return None
        found.loops.append(loop)
        found.starts.append(start)
        found.runs.append(stop.plus(start, -1))
        found.body = loop.body
    return found if found.loops and is_straight(found.body, extents.writing) else None
