"""scheduled_adjoint: the adjoint of an outlined loop by a schedule of the user's, which is a table.

    def f_k_loop_forward(n, u):                     def f_k_loop_adjoint(n, u, u_bar, kept):
        ...                                             place, trips, u_snapshots = kept
        for k in range(n):                              for k in range(trips - 1, -1, -1):
            if k == SCHEDULE[place, 0]:                     start = SCHEDULE[place, 0]
                row = SCHEDULE[place, 1]                    row = SCHEDULE[place, 1]
                u_snapshots[row] = u                        u_again[:] = u_snapshots[row]
                place += 1                                  place += 1
            f_k_step(k, u)                                  for again in range(start, k):
        ...                                                     ... keep some, as in the first half ...
        return (place, trips, u_snapshots)                      f_k_step(again, u_again)
                                                            place += 1
                                                            f_k_step_adjoint(k, u_again, u_bar)

An entry of the table is a step and the row of the state before it: first those that the first half keeps, then for each
step that is reversed the one from which steps run again, and those that are kept on the way; behind each comes an entry
of no step.
"""
from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from s2sad.differentiate.checkpointed_adjoint import CheckpointedAdjoint
from s2sad.infer.types import INT
from s2sad.program import Schedule, Table
from s2sad.tree import (
    AST, Add, Assert, Eq, If, assign, augment, call, compare, const, copy, counted_for, index, name,
)

OTHER_STEPS = "a loop runs another number of steps than its schedule: make the schedule for the number that it runs"


class ScheduledAdjoint(CheckpointedAdjoint):
    """The two halves where a schedule says which states are kept."""

    def bookkeeping(self) -> list[str]:
        self.place, self.start, self.row = (self.new(n, INT) for n in ("place", "start", "row"))
        return [self.place]

    @property
    def schedule(self) -> Schedule:
        assert self.loop.snapshots.schedule is not None
        return self.loop.snapshots.schedule

    @property
    def table(self) -> str:
        """The name of the table, a constant of the module."""
        return f"{self.loop.callee.removesuffix('_step').upper()}_SCHEDULE"

    def constants(self) -> dict[str, Table]:
        return {self.table: self.schedule.entries}

    def entry(self, column: int) -> AST:
        """The step (0) or the row (1) of the entry that is next."""
        return index(name(f"const.{self.table}"), name(self.place), const(column))

    def counted(self) -> list[AST]:
        trips = call("builtins.len", copy(self.loop.loop.iter))
        before: list[AST] = [Assert(compare(trips, Eq(), const(self.schedule.steps)), const(OTHER_STEPS)),
                             assign(self.trips, const(self.schedule.steps)), *self.allocated(self.rows()),
                             assign(self.place, const(0))]
        return [*before, *self.with_trips([self.kept_on_the_way(self.trip), copy(self.loop.step)]),
                augment(self.place, Add(), const(1))]

    def kept_on_the_way(self, trip: str, arrays: Mapping[str, str] = MappingProxyType({})) -> AST:
        """The state before a step is kept where that is the next entry's."""
        made = [assign(index(name(s), name(self.row)), self.part(n, arrays)) for n, s in self.stored.items()]
        return If(compare(name(trip), Eq(), self.entry(0)),
                  [assign(self.row, self.entry(1)), *made, augment(self.place, Add(), const(1))], [])

    def rows(self) -> AST:
        return const(self.schedule.rows)

    def state_before(self) -> list[AST]:
        again = self.new("again", INT)
        forth = augment(self.place, Add(), const(1))
        return [assign(self.start, self.entry(0)), assign(self.row, self.entry(1)), *self.loaded(name(self.row)), forth,
                counted_for(again, [name(self.start), name(self.trip)],
                            [self.kept_on_the_way(again, self.again), self.called(name(again))]), copy(forth)]

    def state_after(self) -> list[AST]:
        return []
