"""trip_counters: the trips of loops whose number is known only after they have run, and the number of an iteration.

    trips = 0                               for trip in range(trips - 1, -1, -1):
    while ...:                                  x = x_stack[trip]
        x_stack[trips] = x                      ...
        ...
        trips += 1
"""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.analyze.dependence import range_parts
from s2sad.analyze.recording_plan import RecordingPlan
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.trip_counts import counter
from s2sad.infer.types import INT
from s2sad.naming import Names
from s2sad.tree import AST, For, If, Name, Subscript, While, const, name, sub, walk


@dataclass
class TripCounters:
    """The counters of a function's loops, by the loops' ids: `trips` in the forward, `iterations` in the reverse sweep.
    """
    structure: ProgramStructure
    plan: RecordingPlan
    free: Names
    trips: dict[int, str] = field(default_factory=dict)
    iterations: dict[int, str] = field(default_factory=dict)

    def is_counted_at_run_time(self, loop: AST) -> bool:
        """Whether the trips of a loop are known only when it has run."""
        return isinstance(loop, While) or has_break(loop)

    def count(self, loop: AST) -> str:
        """The name of the number of trips."""
        return self._named(self.trips, loop, "trips")

    def in_loop(self, loop: AST) -> bool:
        """Whether the count of a loop is overwritten by the next iteration around it."""
        loops = self.structure.place(loop).loops
        return bool(loops) and id(loops[-1]) not in self.plan.rerun

    def iteration(self, loop: AST, carried: bool) -> tuple[AST, AST] | None:
        """The number of an iteration in the forward and in the reverse sweep, from 0; None if it is not known.

        `carried`: where the iteration begins, else later in it. A while loop is counted where its iteration ends, or
        after what is carried if the loop may be left before.
        """
        if isinstance(loop, For):
            start, _, step = range_parts(loop)
            read = any(isinstance(n, Subscript) and isinstance(n.value, Name) for n in walk(start))
            return (counter(loop), counter(loop)) if step in (1, -1) and not read else None
        if id(loop) not in self.plan.reversed:
            return None
        trips = name(self.count(loop))
        forward = sub(trips, const(1)) if has_break(loop) and not carried else trips
        return forward, name(self._named(self.iterations, loop, "trip"))

    def _named(self, names: dict[int, str], loop: AST, base: str) -> str:
        if id(loop) not in names:
            names[id(loop)] = self.structure.typing.declare(self.free.fresh(base), INT)
        return names[id(loop)]


def has_break(loop: AST) -> bool:
    """Whether a loop may be left by a break of its own."""
    waiting = list(loop.body)
    while waiting:
        statement = waiting.pop()
        if isinstance(statement, If):
            waiting += [*statement.body, *statement.orelse]
        elif type(statement).__name__ == "Break":
            return True
    return False
