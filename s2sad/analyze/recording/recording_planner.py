"""recording_planner: what is recorded is a minimum cut between lost values and values that are read.

(Moses et al., SC 2021, section 4.2.)
"""
from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable, Mapping
from math import prod

from s2sad.analyze.dependence import ArrayReference
from s2sad.liveness import base_name, targets
from s2sad.analyze.recording.recomputation import RecomputationPlaces
from s2sad.analyze.recording_plan import (
    IterationState, RecordingPlan, RecordingProblem, Shift, Snapshot, Store, by_key, reads, subscripts,
)
from s2sad.analyze.reallocated_arrays import is_remade, reallocations_to_reverse
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.uses import loads_of
from s2sad.analyze.reverse_values import ReverseValue
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import AST, Assign, AugAssign, Expr, dump


def plan_for(problem: RecordingProblem, rerun: Mapping[int, IterationState], shifts: dict[str, Shift] | None = None
             ) -> RecordingPlan:
    """The plan in which the loops in `rerun` run again; to restore what is recorded may require more."""
    table = problem.structure
    reallocated = {id(a): a for a in reallocations_to_reverse(table, problem.active)
                   if id(table.place(a).loops[-1]) not in rerun}
    reversed: set[int] = {id(s) for a in reallocated.values() for s in table.place(a).inside}
    restored: set[int] = set(reallocated)
    while True:
        planner = RecordingPlanner(problem, rerun, reversed, restored, shifts or {})
        plan = planner.plan()
        plan.reallocated = {i for i in restored if is_allocation(table.places[i].statement)}
        plan.remade = {i for i in plan.reallocated if planner.is_remade(table.places[i].statement)}
        recorded_at = [s.statement for s in plan.stores.values()] + [v.home for v in plan.recorded.values()]
        more = {id(s) for x in recorded_at for s in table.place(x).inside}
        more |= {id(s) for value in plan.recorded.values() for b in value.bindings
                 for s in table.place(b).inside}
        if more <= plan.reversed and {id(x) for x in recorded_at} <= restored:
            return plan
        reversed = plan.reversed | more
        restored |= {id(x) for x in recorded_at}


class RecordingPlanner(RecomputationPlaces):
    """The plan for one choice of loops that run again."""

    def plan(self) -> RecordingPlan:
        """What is reversed, needs, placements, the network, the cut, and what follows from it."""
        self.find_reversed()
        self.result.unread = self.problem.unread
        self.result.after = frozenset(i for i, p in self.structure.places.items() if self.problem.after(p.statement))
        required: list[tuple[str, AST]] = []
        mandatory: list[tuple[AST, AST]] = []
        for place in self.structure.places.values():
            found = self.needs(place.statement)
            required += [(n, place.statement) for n in sorted(found.names)]
            mandatory += [(load, place.statement) for load in found.loads]
        self.collect(required)
        self.place_values()
        self.build(required, mandatory)
        self.cut(mandatory)
        self.result.readers = {key: self.readers_of(key) for key in (*self.result.recorded, *self.result.stores)}
        return self.result

    def build(self, required: list[tuple[str, AST]], mandatory: list[tuple[AST, AST]]) -> None:
        for store in self.stores:
            self.network.node(store.key, self.store_weight(store))
            self.network.source(store.key)
        for key, value in self.result.values.items():
            self.network.node(key, self.weight(value))
        for key, value in self.result.values.items():
            if self.placement[key] == "lost":
                self.network.source(key)
                continue
            if self.placement[key] == "shifted":
                self.network.sink(self.shifts[key].store.key)
                start = self.all_values.at(self.shifts[key].start, self.shifts[key].loop)
                if start is not None and start.key in self.result.values:
                    self.network.edge(start.key, key)
                continue
            for store in self.conflicts_of(value):
                self.network.edge(store.key, key)
            if key not in self.result.reloaded:
                self.link(value)
        for key, users in self.users.items():
            if any(not isinstance(u, str) for u in users):
                self.network.sink(key)

    def link(self, value: ReverseValue) -> None:
        for name, statement in self.inputs(value):
            inner = self.all_values.at(name, statement)
            if inner is not None and inner.key in self.result.values and inner.key != value.key:
                self.network.edge(inner.key, value.key)

    def conflicts_of(self, value: ReverseValue) -> list[Store]:
        if value.key not in self.loads:
            stored = self.result.reloaded.get(value.key)
            loads = self.value_loads(value) if stored is None else [
                (targets(stored)[0], stored), *((x, stored) for x in loads_of(subscripts(stored), self.typing))]
            by_array = _by_array(loads)
            found = [s for array, those in by_array.items() for s in self.stores_to.get(array, ())
                     if any(self.conflict(s, x, y) for x, y in those)]
            self.loads[value.key] = found if len(by_array) < 2 else sorted(
                found, key=lambda s: self.structure.place(s.statement).order)
        return self.loads[value.key]

    def conflict(self, store: Store, load: AST, statement: AST, itself: bool = False, again: bool = False) -> bool:
        """Whether a store must_be_restored what a load of the reverse sweep must still find.

        `itself` counts the store of the load's own statement; `again` says that the load runs with its loop again.
        """
        if base_name(store.place) != base_name(load):
            return False
        here, there = self.structure.place(statement), self.structure.place(store.statement)
        if any(s.array == base_name(load) and any(x is s.loop for x in there.loops)
               and not any(x is s.loop for x in here.loops) for s in self.result.snapshots):
            return False  # after the reverse loop the array is again what it was before the loop
        first, later = ArrayReference.to(load, statement), ArrayReference.to(store.place, store.statement)
        loop = next((x for x in here.loops if id(x) in self.rerun), None)
        if loop is None:
            return self.problem.dependence.may_overwrite(first, later, same=itself)
        if any(x is loop for x in there.loops):
            return not again and self.problem.dependence.may_overwrite(first, later, loop, same=itself)
        private = base_name(load) not in self.rerun[id(loop)].persistent and any(
            x is loop for s in self.stores_to.get(base_name(load), ()) for x in self.structure.place(s.statement).loops)
        return not private and self.problem.dependence.may_overwrite(first, later, same=itself)

    def depth(self, loops: tuple[AST, ...]) -> int:
        last = max((k for k, loop in enumerate(loops) if id(loop) in self.rerun), default=-1)
        return len(loops) - 1 - last

    def weight(self, value: ReverseValue) -> int:
        size = 1 if self.typing.table[value.name].dtype == "bool" else 8
        loops = self.structure.place(value.home).loops
        return size * 16 ** (self.depth(loops) + (value.kind == "carried"))

    def store_weight(self, store: Store) -> int:
        rank = self.typing.of(store.place).rank
        return 8 * 16 ** (self.depth(self.structure.place(store.statement).loops) + rank)

    def cut(self, mandatory: list[tuple[AST, AST]]) -> None:
        """The minimum cut, and which of the other values are recomputed, and where."""
        self.mandatory = _by_array(mandatory)
        self.rerun_loads = _by_array([(load, place.statement) for place, _ in self.rerun_places()
                                for load in reads(place.statement, self.typing)])
        for array, stores in self.stores_to.items():
            needed, again = self.mandatory.get(array, ()), self.rerun_loads.get(array, ())
            for store in stores:
                if any(self.must_be_restored(store, load, s) for load, s in needed) or any(
                        self.conflict(store, load, s, again=True) for load, s in again):
                    self.network.sink(store.key)
        cut = dict.fromkeys(self.network.least_cut())
        self.result.weight = sum(self.network.weights[k] for k in cut) + sum(
            weight_of(s, self.structure) for s in self.result.snapshots)
        self.result.stores = {s.key: s for s in self.stores if s.key in cut}
        self.result.recorded = {k: v for k, v in self.result.values.items() if k in cut}
        kept = self.recomputed(cut)
        for key in kept:
            value = self.result.values[key]
            place = self.structure.place(value.home)
            if self.placement[key] == "shifted":
                self.result.shifted[key] = self.shifts[key]
            elif self.placement[key] == "late":
                self.result.late.setdefault((place.block, place.segment), []).append(key)
            else:
                self.result.early.setdefault(place.block, []).append(key)
        self.result.reloaded = {k: s for k, s in self.result.reloaded.items() if k in kept}
        again = ((k, v) for k, v in self.result.values.items() if self.placement[k] != "lost" and k not in cut)
        self.restored_for = by_key(((s.key, k) for k, v in again for s in self.conflicts_of(v) if s.key in cut),
                                   lambda pair: pair[0])

    def readers_of(self, key: str) -> list[AST]:
        """The statements whose reversal needs what is recorded under a key, in the order of the text."""
        found: list[AST] = []
        waiting, seen = [key], {key}
        store = self.result.stores.get(key)
        if store is not None:
            found += [s for load, s in self.mandatory.get(base_name(store.place), ())
                      if self.must_be_restored(store, load, s)]
            found += [s for load, s in self.rerun_loads.get(base_name(store.place), ())
                      if self.conflict(store, load, s, again=True)]
            waiting = [k for _, k in self.restored_for.get(key, ())]
        while waiting:
            for user in self.users.get(waiting.pop(), []):
                if not isinstance(user, str):
                    found.append(user)
                elif user not in seen and user not in self.result.recorded:
                    seen.add(user)
                    waiting.append(user)
        self.result.between |= seen
        return sorted({id(s): s for s in found}.values(), key=lambda s: self.structure.place(s).order)

    def recomputed(self, cut: Collection[str]) -> dict[str, None]:
        """The values that are recomputed: those that are read and not recorded, back to recorded ones."""
        waiting = deque(k for k, users in self.users.items() if any(not isinstance(u, str) for u in users))
        seen: dict[str, None] = {}
        while waiting:
            key = waiting.popleft()
            if key in seen or key in cut:
                continue
            seen[key] = None
            if key in self.result.reloaded:
                continue
            if self.placement[key] == "shifted":
                start = self.all_values.at(self.shifts[key].start, self.shifts[key].loop)
                waiting += [start.key] if start is not None and start.key in self.result.values else []
                continue
            for name, statement in self.inputs(self.result.values[key]):
                inner = self.all_values.at(name, statement)
                if inner is not None and inner.key in self.result.values:
                    waiting.append(inner.key)
        return seen

    def must_be_restored(self, store: Store, load: AST, statement: AST) -> bool:
        """Whether a store must be undone for a load of a statement's adjoint: what the statement itself overwrites is
        put back as it was before it, whatever was stored there since, unless the adjoint reads what it left there. A
        call that fills an array before it reads it runs again whatever it holds (`work_arrays`)."""
        if store.statement is statement and self.problem.refills(statement, base_name(load)):
            return False
        if not self.conflict(store, load, statement, self.overwrites_operands(statement)):
            return False
        if self.problem.after(statement):
            return True
        own = next((s for s in self.stores_by.get(id(statement), ()) if dump(s.place) == dump(load)), None)
        return own is None or own is store or self.problem.refills(statement, base_name(load)) or not self.conflict(
            own, load, statement, self.overwrites_operands(statement))

    def is_remade(self, statement: Assign) -> bool:
        """Whether the reverse of an iteration allocates an array anew: nothing there reads what was in it."""
        array = statement.targets[0].id
        again = [k for keys in (*self.result.early.values(), *self.result.late.values()) for k in keys]
        read = {base_name(load) for k in again for load, _ in self.value_loads(self.result.values[k])}
        read |= {base_name(targets(s)[0]) for s in self.result.reloaded.values()}
        if array in read or array in self.mandatory or array in self.rerun_loads or any(
                s.statement is statement for s in self.result.stores.values()):
            return False

        def lasting(number: str, user: AST) -> bool:
            value = self.all_values.at(number, user)
            return value is None or not self.all_values.transient(value, self.rerun)
        return is_remade(self.structure, statement, lasting)

    def overwrites_operands(self, statement: AST) -> bool:
        """Whether a statement's own store can overwrite what its adjoint reads."""
        return isinstance(statement, (Assign, AugAssign, Expr)) and not self.problem.after(statement)


def _by_array(loads: Iterable[tuple[AST, AST]]) -> dict[str, list[tuple[AST, AST]]]:
    """Loads with their statements, by the array."""
    return by_key(loads, lambda pair: base_name(pair[0]))


def weight_of(snapshot: Snapshot, structure: ProgramStructure) -> int:
    """The weight of the snapshots of all iterations; an axis counts as 16, or by its length where that is less."""
    rank = structure.typing.table[snapshot.array].rank
    lengths = [min(structure.lengths.get((snapshot.array, axis), 16), 16) for axis in range(rank)]
    return 8 * 16 ** (len(structure.place(snapshot.loop).loops) + 1) * prod(lengths)
