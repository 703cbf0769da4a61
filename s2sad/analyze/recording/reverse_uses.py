"""reverse_uses: the lost values that the reverse sweep reads, back to values that are never lost."""
from __future__ import annotations

from collections import deque
from collections.abc import Mapping

from s2sad.analyze.recording.min_cut import Network
from s2sad.liveness import base_name, targets
from s2sad.analyze.recording_plan import IterationState, RecordingPlan, RecordingProblem, Shift, Store, by_key
from s2sad.analyze.program_structure import StatementPlace, heads
from s2sad.analyze.uses import OperandUses
from s2sad.analyze.reverse_values import ReverseValue
from s2sad.tree import AST, Assign, For, If, Name, names


class ReverseUses:
    """The values that the reverse sweep requires, with their users."""

    def __init__(self, problem: RecordingProblem, rerun: Mapping[int, IterationState], reversed: set[int],
                 restored: set[int], shifts: dict[str, Shift]):
        self.problem, self.rerun, self.restored, self.shifts = problem, rerun, restored, shifts
        self.structure, self.typing = problem.structure, problem.structure.typing
        self.all_values = problem.reverse_values
        self.result = RecordingPlan(rerun=rerun, reversed=set(reversed))
        self.users: dict[str, list[AST | str]] = {}
        self.stores = [Store(p.statement, t, self._is_whole(t)) for p in problem.structure.places.values()
                       for t in problem.stores(p.statement)]
        self.stores_to = by_key(self.stores, lambda s: base_name(s.place))
        self.stores_by = by_key(self.stores, lambda s: id(s.statement))
        self.stored = by_key((s for s in self.stores if isinstance(s.statement, Assign) and isinstance(
            s.statement.value, Name)), lambda s: s.statement.value.id)
        self.network = Network()
        self.loads: dict[str, list[Store]] = {}
        self.mandatory: dict[str, list[tuple[AST, AST]]] = {}
        self.rerun_loads: dict[str, list[tuple[AST, AST]]] = {}
        self.restored_for: dict[str, list[tuple[str, str]]] = {}
        self.placement: dict[str, str] = {}
        self.first: set[str] = set()

    def _is_whole(self, place: AST) -> bool:
        return self.typing.of(place).is_array

    def find_reversed(self) -> None:
        """The compound statements with something to reverse in them."""
        for place in self.structure.places.values():
            if self.problem.active(place.statement):
                self.result.reversed |= {id(s) for s in place.inside}

    def needs(self, statement: AST) -> OperandUses:
        """What reversing one statement reads, bounds and tests of reversed loops and branches included."""
        found = OperandUses()
        if isinstance(statement, If) and id(statement) in self.result.reversed:
            found.value(statement.test, self.typing)
        elif isinstance(statement, For) and id(statement) in self.result.reversed:
            for bound in statement.iter.args:
                found.value(bound, self.typing)
        elif self.problem.active(statement):
            found = self.problem.uses(statement)
        if id(statement) in self.restored:
            self.needs_of_restore(statement, found)
        return found

    def needs_of_restore(self, statement: AST, found: OperandUses) -> None:
        """What restoring an element reads: its subscripts and the tests on the way, before any recomputation."""
        before = OperandUses()
        for target in targets(statement):
            before.place(target, self.typing)
        for branch, _ in self.structure.place(statement).branches:
            before.value(branch.test, self.typing)
        self.first |= {v.key for n in before.names if (v := self.all_values.at(n, statement)) is not None}
        found.names |= before.names
        found.loads += before.loads

    def rerun_places(self) -> list[tuple[StatementPlace, AST]]:
        """The statements in loops that run again, each with its loop."""
        return [(place, loop) for place in self.structure.places.values() for loop in place.loops
                if id(loop) in self.rerun]

    def collect(self, required: list[tuple[str, AST]]) -> None:
        """The required values with their users, back to those that are never lost."""
        waiting: deque[tuple[str, AST | str, AST]] = deque((n, s, s) for n, s in required)
        for place, loop in self.rerun_places():
            for name in names(heads(place.statement)):
                value = self.all_values.at(name, place.statement)
                if value is not None and not any(x is loop for x in self.structure.place(value.home).loops):
                    waiting.append((name, place.statement, place.statement))
        seen: set[tuple[str, int]] = set()
        while waiting:
            name, user, statement = waiting.popleft()
            value = self.all_values.at(name, statement)
            if value is None or not self.all_values.transient(value, self.rerun):
                continue
            self.users.setdefault(value.key, []).append(user)
            self.result.values[value.key] = value
            if value.key in self.shifts:
                waiting.append((self.shifts[value.key].start, value.key, self.shifts[value.key].loop))
            if value.kind in ("carried", "opaque") or (value.key, 0) in seen:
                continue
            seen.add((value.key, 0))
            waiting += [(n, value.key, b) for n, b in self.inputs(value)]

    def inputs(self, value: ReverseValue) -> list[tuple[str, AST]]:
        """The names that the recomputation of a value reads, those of the branches around its bindings included."""
        found = value.reads()
        home = self.structure.place(value.home)
        for binding in value.bindings:
            outer = len(home.branches) if value.kind == "merge" else self._segment_branches(binding)
            for branch, _ in self.structure.place(binding).branches[outer:]:
                found += [(n, branch) for n in names(branch.test)]
        return found

    def _segment_branches(self, statement: AST) -> int:
        """How many of the branches around a statement are outside its segment."""
        place = self.structure.place(statement)
        return sum(not self.structure.is_simple(b) for b, _ in place.branches)
