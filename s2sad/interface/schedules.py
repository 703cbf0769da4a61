"""Schedules of the package checkpoint-schedules as tables: which states are kept, where, and whence steps run again.

Nothing is imported of it: a schedule is what yields its actions, which are known by what they are called.
"""
from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NoReturn

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.program import NOTHING, Schedule

_MOST = 10_000_000      # actions of a schedule that never ends


def is_schedule(given: Any) -> bool:
    """Whether something is a schedule of that package."""
    return hasattr(given, "max_n") and hasattr(given, "uses_storage_type")


def schedule_of(given: Any) -> Schedule:
    """The table of a schedule, which is not used up; raises S2sadError (S408) for one that cannot be followed."""
    title = type(given).__name__
    if given.max_n is None:
        raise _refused(title, "learns the number of steps while they run", "give one that is made for their number")
    if given.n or given.r:
        raise _refused(title, "has been used", "give a new one")
    return _Reading(title, int(given.max_n)).table(copy.deepcopy(given))


def _refused(title: str, what: str, remedy: str = "") -> S2sadError:
    return S2sadError(Diagnostic("S408", f"the schedule {title} {what}", help=remedy))


@dataclass
class _Reading:
    """One schedule on its way into a table. `held` has the row of each state by step and storage, `path` the state from
    which steps run now, with its row, and `kept` those that are kept on the way; `here` is the step that is next."""
    title: str
    steps: int
    held: dict[tuple[int, str], int] = field(default_factory=dict)
    entries: list[tuple[int, int]] = field(default_factory=list)
    path: tuple[int, int] | None = None
    kept: list[tuple[int, int]] = field(default_factory=list)
    here: int = 0
    left: int = 0       # steps that are not reversed
    forwards: bool = True
    rows: int = 0
    on_disk: bool = False

    def table(self, schedule: Iterator[Any]) -> Schedule:
        self.left = self.steps
        for count, action in enumerate(schedule):
            kind = type(action).__name__
            if kind == "EndReverse":
                break
            follow = getattr(self, f"_{kind.lower()}", None)
            if follow is None or count > _MOST:
                raise _refused(self.title, f"has the action {action}, which is not known")
            follow(action)
        if self.left:
            raise _refused(self.title, f"reverses {self.steps - self.left} of {self.steps} steps")
        return Schedule(self.title, self.steps, self.rows, self.on_disk, tuple(self.entries))

    def wrong(self, action: Any) -> NoReturn:
        raise _refused(self.title, f"has the action {action} where it cannot be followed")

    def _forward(self, action: Any) -> None:
        first, last = int(action.n0), min(int(action.n1), self.steps)
        if self.here != first or not self.forwards and self.path is None:
            self.wrong(action)
        storage, self.here = action.storage.name, last
        in_work = storage not in ("RAM", "DISK")
        if action.write_ics:
            if in_work:
                self.wrong(action)
            self.keep(first, storage)
        if action.write_adj_deps and not (in_work and not self.forwards and last == first + 1):
            for step in range(first, last):     # a tape is had again from the state before its step
                self.keep(step, storage)

    def keep(self, step: int, storage: str) -> None:
        """The state before a step is kept; one that is held elsewhere is not held twice."""
        self.on_disk |= storage == "DISK"
        there = [row for (held, _), row in self.held.items() if held == step]
        taken = {*self.held.values()}
        row = there[0] if there else next(r for r in range(len(taken) + 1) if r not in taken)
        self.rows, self.held[step, storage] = max(self.rows, row + 1), row
        if not there:
            self.kept.append((step, row))

    def _endforward(self, action: Any) -> None:
        if self.here != self.steps:
            self.wrong(action)
        self.entries += [*self.kept, NOTHING]
        self.kept, self.forwards = [], False

    def _copy(self, action: Any) -> int:
        step, target = int(action.n), action.to_storage.name
        row = self.held.get((step, action.from_storage.name))
        if row is None or self.kept:
            self.wrong(action)
        if target == "WORK":
            self.path, self.here = (step, row), step
        elif target is not None and target != "NONE":
            self.held[step, target] = row
            self.on_disk |= target == "DISK"
        return step

    def _move(self, action: Any) -> None:
        step = self._copy(action)
        if action.from_storage is not action.to_storage:
            del self.held[step, action.from_storage.name]

    def _reverse(self, action: Any) -> None:
        if int(action.n1) != self.left:
            self.wrong(action)
        for step in range(self.left - 1, int(action.n0) - 1, -1):
            row = self.held.pop((step, "WORK"), None)
            if self.path is not None and self.path[0] <= step <= self.here <= step + 1:
                self.entries += [self.path, *(k for k in self.kept if k[0] != step), NOTHING]
            elif row is not None and not self.kept:
                self.entries += [(step, row), NOTHING]
            else:
                self.wrong(action)
            self.path, self.kept, self.left = None, [], step
