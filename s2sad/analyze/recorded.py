"""recorded: what the forward sweep records, what the reverse sweep computes again, and which loops it runs again.

Requires structure, activity and what each adjoint reads; establishes a `Plan`. A value that the reverse sweep reads
and that later iterations overwrite is
- computed again where its operands are intact or restored, at the top of the reverse block ("early": in the state
  that the block leaves) or of its own segment ("late": in the state in which the segment begins),
- read back from the element where it was stored ("reloaded"),
- or recorded. An element that is overwritten while something computed again still reads it is recorded and restored.
What to record is a least cut between what is lost and what is read. (To be recorded: Hascoet, Naumann, Pascual, FGCS
21, 2005; the cut: Moses et al., SC 2021.) A loop whose iterations share no flow except sums can be run forward and
back per iteration: its tape is then that of one iteration (Hascoet, Pascual, TOMS 39, 2013, II-LOOP).
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from s2sad.analyze.cut import Network
from s2sad.analyze.dependence import Dependence, Reference
from s2sad.analyze.liveness import base_name, targets
from s2sad.analyze.trips import known_trips
from s2sad.analyze.structure import Place, Structure, is_simple
from s2sad.analyze.uses import Uses, loads_of
from s2sad.analyze.values import Value, Values
from s2sad.infer.infer import Typing
from s2sad.tree import AST, Assign, AugAssign, Call, Expr, For, If, Name, Subscript, While, dump, names


@dataclass(frozen=True)
class Store:
    """A statement that overwrites (part of) an array; `whole` if not one element."""
    statement: AST
    place: AST
    whole: bool

    @property
    def key(self) -> str:
        return f"store {id(self.statement)} {dump(self.place)}"


@dataclass(frozen=True)
class Shift:
    """A carried number that is what an element held which the iteration before overwrote: its record serves both.
    `start` is the number's name before the loop."""
    store: Store
    start: str
    loop: AST


@dataclass
class Plan:
    """The table. Keys are ids of statements and blocks of the function that was analysed."""
    rerun: frozenset[int] = frozenset()
    values: dict[str, Value] = field(default_factory=dict)
    recorded: dict[str, Value] = field(default_factory=dict)
    stores: dict[str, Store] = field(default_factory=dict)
    early: dict[int, list[str]] = field(default_factory=dict)
    late: dict[tuple[int, int], list[str]] = field(default_factory=dict)
    reloaded: dict[str, AST] = field(default_factory=dict)
    shifted: dict[str, Shift] = field(default_factory=dict)
    working: set[int] = field(default_factory=set)
    forwards: frozenset[int] = frozenset()
    weight: int = 0
    readers: dict[str, list[AST]] = field(default_factory=dict)


@dataclass
class Question:
    """What the planner is told: the tables, what each statement's adjoint reads, and what each statement writes."""
    structure: Structure
    dependence: Dependence
    active: Callable[[AST], bool]
    uses: Callable[[AST], Uses]
    writes: Callable[[AST], list[AST]]


def recorded(question: Question) -> Plan:
    """The plan of least weight found: loops are tried for running again, outermost first, then carried numbers for
    being read from another record."""
    plan = rerun_plan(question)
    shifts = {k: s for k, v in plan.recorded.items() if (s := shift_of(v, plan, question)) is not None}
    if shifts:
        other = plan_for(question, plan.rerun, shifts)
        plan = other if other.weight < plan.weight else plan
    return plan


def shift_of(value: Value, plan: Plan, question: Question) -> Shift | None:
    """How a carried number that is recorded can be read from the record of an element, if it can."""
    structure, loop = question.structure, value.home
    if value.kind != "carried" or len(value.bindings) != 2 or not isinstance(loop, For):
        return None
    before, copied = value.bindings
    if not isinstance(before.value, Name) or not isinstance(copied.value, Name):
        return None
    load = structure.bindings.get(copied.value.id, [])
    while len(load) == 1 and isinstance(load[0], Assign) and isinstance(load[0].value, Name):
        load = structure.bindings.get(load[0].value.id, [])
    if len(load) != 1 or not isinstance(load[0], Assign) or not isinstance(load[0].value, Subscript):
        return None
    here, end = structure.place(load[0]), structure.place(copied)
    for store in plan.stores.values():
        there = structure.place(store.statement)
        same = (here.block, here.segment) == (there.block, there.segment) == (end.block, end.segment)
        plain = not here.branches and not there.branches and not end.branches or (
            here.branches == there.branches == end.branches == structure.place(loop).branches)
        last = max((k for k, x in enumerate(there.loops) if id(x) in plan.rerun), default=-1)
        home = next((x for x in there.loops if id(x) in plan.rerun), there.loops[0] if there.loops else loop)
        if (same and plain and here.loops[-1:] == (loop,) and here.order < there.order
                and dump(store.place) == dump(load[0].value) and _undisturbed(store, load[0], plan, question)
                and known_trips(structure, there.loops[last + 1:], home) is not None):
            return Shift(store, before.value.id, loop)
    return None


def _undisturbed(store: Store, load: AST, plan: Plan, question: Question) -> bool:
    """Whether nothing overwrites an element between its load and its store."""
    structure = question.structure
    here, there = structure.place(load), structure.place(store.statement)
    between = [p.statement for p in structure.places.values() if here.order < p.order < there.order]
    return not any(base_name(t) == base_name(store.place) for s in between for t in question.writes(s))


def rerun_plan(question: Question) -> Plan:
    """The plan of least weight in which loops run again."""
    plan = plan_for(question, frozenset())
    for place in sorted(question.structure.places.values(), key=lambda p: p.order):
        loop = place.statement
        if isinstance(loop, For) and plan.weight and not any(id(x) in plan.rerun for x in place.loops):
            if may_rerun(loop, question):
                other = plan_for(question, plan.rerun | {id(loop)})
                plan = other if other.weight < plan.weight else plan
    return plan


def plan_for(question: Question, rerun: frozenset[int], shifts: dict[str, Shift] | None = None) -> Plan:
    """The plan in which the given loops run again; what is recorded must be restored, which may need more."""
    working: set[int] = set()
    restored: set[int] = set()
    while True:
        plan = Planner(question, rerun, working, restored, shifts or {}).plan()
        recorded_at = [s.statement for s in plan.stores.values()] + [v.home for v in plan.recorded.values()]
        more = {id(s) for x in recorded_at for s in question.structure.place(x).inside}
        more |= {id(s) for value in plan.recorded.values() for b in value.bindings
                 for s in question.structure.place(b).inside}
        if more <= plan.working and {id(x) for x in recorded_at} <= restored:
            return plan
        working = plan.working | more
        restored |= {id(x) for x in recorded_at}


class Planner:
    def __init__(self, question: Question, rerun: frozenset[int], working: set[int], restored: set[int],
                 shifts: dict[str, Shift]):
        self.q, self.rerun, self.restored, self.shifts = question, rerun, restored, shifts
        self.structure, self.typing = question.structure, question.structure.typing
        self.all_values = Values(question.structure)
        self.result = Plan(rerun=rerun, working=set(working))
        self.users: dict[str, list[AST | str]] = {}
        self.stores = [Store(p.statement, t, self._is_whole(t)) for p in question.structure.places.values()
                       for t in question.writes(p.statement)]
        self.network = Network()
        self.loads: dict[str, list[Store]] = {}
        self.placement: dict[str, str] = {}
        self.first: set[str] = set()

    def _is_whole(self, place: AST) -> bool:
        return self.typing.of(place).is_array

    # -- what is read ------------------------------------------------------------------------------------------------

    def plan(self) -> Plan:
        """Work, needs, placements, the network, the cut, and what follows from it."""
        self.find_work()
        wanted: list[tuple[str, AST]] = []
        mandatory: list[tuple[AST, AST]] = []
        for place in self.structure.places.values():
            found = self.needs(place.statement)
            wanted += [(n, place.statement) for n in sorted(found.names)]
            mandatory += [(load, place.statement) for load in found.loads]
        self.collect(wanted)
        self.place_values()
        self.build(wanted, mandatory)
        self.choose(mandatory)
        self.result.readers = {key: self.readers_of(key, mandatory)
                               for key in (*self.result.recorded, *self.result.stores)}
        return self.result

    def find_work(self) -> None:
        """The compound statements with something in them to reverse."""
        for place in self.structure.places.values():
            if self.q.active(place.statement):
                self.result.working |= {id(s) for s in place.inside}

    def needs(self, statement: AST) -> Uses:
        """What reversing one statement reads, bounds and tests of working loops and branches included."""
        found = Uses()
        if isinstance(statement, If) and id(statement) in self.result.working:
            found.value(statement.test, self.typing)
        elif isinstance(statement, For) and id(statement) in self.result.working:
            for bound in statement.iter.args:
                found.value(bound, self.typing)
        elif self.q.active(statement):
            found = self.q.uses(statement)
        if id(statement) in self.restored:
            self.restoring(statement, found)
        return found

    def restoring(self, statement: AST, found: Uses) -> None:
        """What restoring an element reads: its subscripts and the tests on the way, before anything else is had."""
        before = Uses()
        for target in targets(statement):
            before.place(target, self.typing)
        for branch, _ in self.structure.place(statement).branches:
            before.value(branch.test, self.typing)
        self.first |= {v.key for n in before.names if (v := self.all_values.at(n, statement)) is not None}
        found.names |= before.names
        found.loads += before.loads

    def rerun_places(self) -> list[tuple[Place, AST]]:
        """The statements in loops that run again, each with its loop."""
        return [(place, loop) for place in self.structure.places.values() for loop in place.loops
                if id(loop) in self.rerun]

    def collect(self, wanted: list[tuple[str, AST]]) -> None:
        """The values that must be had again, with who reads them, back to those that are never lost."""
        waiting: list[tuple[str, AST | str, AST]] = [(n, s, s) for n, s in wanted]
        for place, loop in self.rerun_places():
            for name in names(_heads(place.statement)):
                value = self.all_values.at(name, place.statement)
                if value is not None and not any(x is loop for x in self.structure.place(value.home).loops):
                    waiting.append((name, place.statement, place.statement))
        seen: set[tuple[str, int]] = set()
        while waiting:
            name, user, statement = waiting.pop(0)
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

    def inputs(self, value: Value) -> list[tuple[str, AST]]:
        """The names that computing a value again reads, those of the branches around its bindings included."""
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
        return sum(not is_simple(b, self.typing) for b, _ in place.branches)

    # -- where each value is had again -------------------------------------------------------------------------------

    def place_values(self) -> None:
        for key in self.order():
            value = self.result.values[key]
            if value.kind in ("carried", "opaque"):
                self.placement[key] = "shifted" if key in self.shifts else "lost"
                continue
            own = self.segment(value.home)
            late = key not in self.first and all(
                self.location(u) == own and (not isinstance(u, str) or self.placement[u] == "late")
                for u in self.users[key])
            if value.kind == "expression" and self.is_reloaded(value):
                self.placement[key] = "early"
            elif late and self.valid(value, "late"):
                self.placement[key] = "late"
            else:
                self.placement[key] = "early" if self.valid(value, "early") else "lost"

    def order(self) -> list[str]:
        """The values, each after all values that are computed from it."""
        done: dict[str, None] = {}

        def visit(key: str) -> None:
            if key not in done and key not in waiting:
                waiting.add(key)
                for user in self.users[key]:
                    if isinstance(user, str):
                        visit(user)
                done[key] = None

        waiting: set[str] = set()
        for key in self.result.values:
            visit(key)
        return list(done)

    def segment(self, statement: AST) -> tuple[int, int]:
        place = self.structure.place(statement)
        return place.block, place.segment

    def location(self, user: AST | str) -> tuple[int, int]:
        return self.segment(self.result.values[user].home if isinstance(user, str) else user)

    def value_loads(self, value: Value) -> list[tuple[AST, AST]]:
        found = [(load, b) for b in value.bindings for load in loads_of(b.value, self.typing)]
        for name, branch in self.inputs(value):
            if isinstance(branch, If):
                found += [(load, branch) for load in loads_of(branch.test, self.typing)]
        return found

    def valid(self, value: Value, when: str) -> bool:
        """Whether every element that a value reads is in the state in which it is had again as it was."""
        return all(not self.disturbs(store, load, statement, when)
                   for load, statement in self.value_loads(value) for store in self.stores)

    def disturbs(self, store: Store, load: AST, statement: AST, when: str) -> bool:
        """Whether a store of the same iteration makes the state wrong: earlier in the segment, or later in the block."""
        here, there = self.structure.place(statement), self.structure.place(store.statement)
        if base_name(store.place) != base_name(load) or here.block not in there.blocks or not here.loops:
            return False
        a, b = Reference.to(load, statement), Reference.to(store.place, store.statement)
        if when == "late":
            return (there.block, there.segment) == (here.block, here.segment) and there.order < here.order and \
                self.q.dependence.may_overwrite(b, a, here.loops[-1])
        return there.order > here.order and self.q.dependence.may_overwrite(a, b, here.loops[-1])

    def is_reloaded(self, value: Value) -> bool:
        """Whether a value comes back from the element that it was stored in: it replaced one that it was made from."""
        stored = self.stored_at(value)
        if stored is None or self._segment_branches(stored) != len(self.structure.place(stored).branches):
            return False
        indices = [self.all_values.at(n, stored) for n in names(_subscripts(stored))]
        if any(v is not None and self.all_values.transient(v, self.rerun) for v in indices):
            return False
        place = targets(stored)[0]
        chain = self.chain(value, set())
        made_from = any(base_name(load) == base_name(place) and dump(load) == dump(place) for load, _ in chain)
        later = any(self.disturbs(other, place, stored, "early") for other in self.stores)
        if made_from and not later:
            self.result.reloaded[value.key] = stored
        return made_from and not later

    def stored_at(self, value: Value) -> AST | None:
        home = self.structure.place(value.home)
        for store in self.stores:
            statement, place = store.statement, self.structure.place(store.statement)
            if (isinstance(statement, Assign) and isinstance(statement.value, Name) and not store.whole
                    and statement.value.id == value.name and place.block == home.block
                    and place.branches == home.branches):
                return statement
        return None

    def chain(self, value: Value, seen: set[str]) -> list[tuple[AST, AST]]:
        """The loads behind a value, through the values of its own block."""
        seen.add(value.key)
        found = self.value_loads(value)
        for name, statement in self.inputs(value):
            inner = self.all_values.at(name, statement)
            if inner is not None and inner.key not in seen and inner.kind == "expression":
                found += self.chain(inner, seen)
        return found

    # -- the cut -----------------------------------------------------------------------------------------------------

    def build(self, wanted: list[tuple[str, AST]], mandatory: list[tuple[AST, AST]]) -> None:
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

    def link(self, value: Value) -> None:
        for name, statement in self.inputs(value):
            inner = self.all_values.at(name, statement)
            if inner is not None and inner.key in self.result.values and inner.key != value.key:
                self.network.edge(inner.key, value.key)

    def conflicts_of(self, value: Value) -> list[Store]:
        if value.key not in self.loads:
            stored = self.result.reloaded.get(value.key)
            loads = self.value_loads(value) if stored is None else [
                (targets(stored)[0], stored), *((x, stored) for x in loads_of(_subscripts(stored), self.typing))]
            self.loads[value.key] = [s for s in self.stores if any(self.conflict(s, x, y) for x, y in loads)]
        return self.loads[value.key]

    def conflict(self, store: Store, load: AST, statement: AST, itself: bool = False, again: bool = False) -> bool:
        """Whether a store destroys what a load of the reverse sweep must still find.

        `itself` counts the store of the load's own statement; `again` says that the load runs with its loop again.
        """
        if base_name(store.place) != base_name(load):
            return False
        here, there = self.structure.place(statement), self.structure.place(store.statement)
        first, later = Reference.to(load, statement), Reference.to(store.place, store.statement)
        loop = next((x for x in here.loops if id(x) in self.rerun), None)
        if loop is None:
            return self.q.dependence.may_overwrite(first, later, same=itself)
        if any(x is loop for x in there.loops):
            return not again and self.q.dependence.may_overwrite(first, later, loop, same=itself)
        private = any(base_name(s.place) == base_name(load) for s in self.stores
                      if any(x is loop for x in self.structure.place(s.statement).loops))
        return not private and self.q.dependence.may_overwrite(first, later, same=itself)

    def depth(self, loops: tuple[AST, ...]) -> int:
        last = max((k for k, loop in enumerate(loops) if id(loop) in self.rerun), default=-1)
        return len(loops) - 1 - last

    def weight(self, value: Value) -> int:
        size = 1 if self.typing.table[value.name].dtype == "bool" else 8
        loops = self.structure.place(value.home).loops
        return size * 16 ** (self.depth(loops) + (value.kind == "carried"))

    def store_weight(self, store: Store) -> int:
        rank = self.typing.of(store.place).rank
        return 8 * 16 ** (self.depth(self.structure.place(store.statement).loops) + rank)

    def choose(self, mandatory: list[tuple[AST, AST]]) -> None:
        """The cut, and what of the rest is computed again and where."""
        forced = {s.key for s in self.stores for load, statement in mandatory
                  if self.conflict(s, load, statement, isinstance(statement, (Assign, AugAssign, Expr)))}
        forced |= {s.key for s in self.stores for place, _ in self.rerun_places()
                   for load in reads(place.statement, self.typing)
                   if self.conflict(s, load, place.statement, again=True)}
        for key in forced:
            self.network.sink(key)
        cut = self.network.least_cut()
        self.result.weight = sum(self.network.weights[k] for k in cut)
        self.result.stores = {s.key: s for s in self.stores if s.key in cut}
        self.result.recorded = {k: v for k, v in self.result.values.items() if k in cut}
        for key in self.kept(cut):
            value = self.result.values[key]
            place = self.structure.place(value.home)
            if self.placement[key] == "shifted":
                self.result.shifted[key] = self.shifts[key]
            elif self.placement[key] == "late":
                self.result.late.setdefault((place.block, place.segment), []).append(key)
            else:
                self.result.early.setdefault(place.block, []).append(key)
        self.result.reloaded = {k: s for k, s in self.result.reloaded.items() if k in self.kept(cut)}

    def readers_of(self, key: str, mandatory: list[tuple[AST, AST]]) -> list[AST]:
        """The statements whose reversal needs what is recorded under a key, in the order of the text."""
        found: list[AST] = []
        waiting, seen = [key], {key}
        store = self.result.stores.get(key)
        if store is not None:
            found += [s for load, s in mandatory
                      if self.conflict(store, load, s, isinstance(s, (Assign, AugAssign, Expr)))]
            found += [p.statement for p, _ in self.rerun_places() for load in reads(p.statement, self.typing)
                      if self.conflict(store, load, p.statement, again=True)]
            waiting = [k for k, v in self.result.values.items() if self.placement[k] != "lost"
                       and k not in self.result.recorded and any(s is store for s in self.conflicts_of(v))]
        while waiting:
            for user in self.users.get(waiting.pop(), []):
                if not isinstance(user, str):
                    found.append(user)
                elif user not in seen and user not in self.result.recorded:
                    seen.add(user)
                    waiting.append(user)
        return sorted({id(s): s for s in found}.values(), key=lambda s: self.structure.place(s).order)

    def kept(self, cut: list[str]) -> list[str]:
        """The values computed again: those that are read and not recorded, back to what is recorded."""
        waiting = [k for k, users in self.users.items() if any(not isinstance(u, str) for u in users)]
        seen: dict[str, None] = {}
        while waiting:
            key = waiting.pop(0)
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
        return list(seen)


def _heads(statement: AST) -> list[AST]:
    """The expressions of a statement itself, without its blocks."""
    if isinstance(statement, (If, While)):
        return [statement.test]
    if isinstance(statement, For):
        return [statement.iter]
    return [statement]


def _subscripts(statement: AST) -> AST:
    place = targets(statement)[0]
    assert isinstance(place, Subscript)
    return place.slice


def reads(statement: AST, typing: Typing) -> list[AST]:
    """The array references that a statement itself reads; an increment does not read what it adds to."""
    found: list[AST] = []
    for head in _heads(statement):
        if isinstance(head, (Assign, AugAssign)):
            found += loads_of(head.value, typing)
            for target in targets(head):
                found += loads_of(target.slice, typing) if isinstance(target, Subscript) else []
        elif isinstance(head, Expr) and isinstance(head.value, Call):
            found += loads_of(head.value, typing)
        elif not isinstance(head, Expr):
            found += loads_of(head, typing)
    return found


def may_rerun(loop: For, question: Question) -> bool:
    """Whether a loop's iterations can be run again one by one: no number and no element flows between them."""
    structure, typing = question.structure, question.structure.typing
    inner = [p for p in structure.places.values() if any(x is loop for x in p.loops)]
    if not any(isinstance(p.statement, (For, While)) or not is_simple(p.statement, typing) for p in inner):
        return False
    if any(type(p.statement).__name__ == "Break" and p.loops[-1] is loop for p in inner):
        return False
    values = Values(structure)
    if any(x is loop and not _only_sum(structure.bindings[n]) for n, x in values.loops.items()):
        return False
    written = {base_name(t) for p in inner for t in question.writes(p.statement)}
    return all(_private(array, loop, inner, question) for array in sorted(written))


def _only_sum(bound: list[AST]) -> bool:
    return all(isinstance(b, AugAssign) for b in bound[1:])


def _private(array: str, loop: For, inner: list[Place], question: Question) -> bool:
    """Whether an array that the loop writes is read in it only after the same iteration has written all of it,
    and not where the reverse sweep would find what running the loop again leaves."""
    structure, typing = question.structure, question.structure.typing
    start, around = structure.place(loop).order, structure.place(loop).loops
    loads = [(p, x) for p in structure.places.values() for x in reads(p.statement, typing) if base_name(x) == array]
    outside = [p for p, _ in loads if p not in inner and (around or p.order < start)]
    if outside:
        return False
    inside = [(p, x) for p, x in loads if p in inner]
    if not inside:
        return True
    for place in inner:
        for target in question.writes(place.statement):
            if base_name(target) == array and isinstance(place.statement, Assign) and _covers(
                    target, place, loop, question):
                return all(p.order > place.order and _after(p, x, place, target, loop) for p, x in inside)
    return False


def _after(reader: Place, load: AST, place: Place, target: AST, loop: For) -> bool:
    """Whether a load comes after the whole nest that covers the array, or is to the cell just written."""
    nest = place.loops[place.loops.index(loop) + 1:]
    within = bool(nest) and any(x is nest[0] for x in reader.loops)
    return not within or dump(load) == dump(target)


def _covers(place: AST, where: Place, loop: For, question: Question) -> bool:
    reference = Reference.to(place, where.statement)
    nest = where.loops[where.loops.index(loop) + 1:]
    if not reference.subscripts:
        return where.branches == question.structure.place(loop).branches and not nest
    if not nest or not isinstance(nest[0], For):
        return False
    return question.dependence.covers(nest[0], where.statement, reference)
