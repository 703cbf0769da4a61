"""recording_plan: the problem of recording, and its solution: what is recorded, recomputed and run again."""
from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

from s2sad.analyze.dependence import Dependence
from s2sad.liveness import base_name, targets
from s2sad.analyze.program_structure import ProgramStructure, StatementPlace, heads
from s2sad.analyze.uses import OperandUses, loads_of, reads_own_result
from s2sad.analyze.reverse_values import ReverseValue, ReverseValues
from s2sad.infer.inference import Typing
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import AST, Assign, AugAssign, Call, Expr, Subscript, dump

T = TypeVar("T")
K = TypeVar("K", bound=Hashable)


@dataclass(frozen=True)
class Store:
    """A statement that overwrites (part of) an array; `whole` if not one element."""
    statement: AST
    place: AST
    whole: bool

    @cached_property
    def key(self) -> str:
        return f"store {id(self.statement)} {dump(self.place)}"


@dataclass(frozen=True)
class Snapshot:
    """An array as it is where an iteration of a loop begins that runs again."""
    loop: AST
    array: str

    @property
    def key(self) -> str:
        return f"snapshot {id(self.loop)} {self.array}"


@dataclass(frozen=True)
class IterationState:
    """What the iterations of a loop that can run again hand on: in arrays that are overwritten (`flowing`), and in
    cells that keep what they are given until nothing reads them (`persistent`). The `settled` stores give the latter
    what no other store of the loop overwrites: they need not run again."""
    loop: AST
    flowing: tuple[str, ...]
    persistent: tuple[str, ...]
    settled: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Shift:
    """A carried number that is what an element held which the iteration before overwrote: its record serves both.
    `start` is the number's name before the loop."""
    store: Store
    start: str
    loop: AST


@dataclass
class RecordingPlan:
    """The table. Keys are ids of statements and blocks of the function that was analysed: `rerun` are the loops that
    run again, `reversed` the compound statements with something to reverse, `reallocated` the allocations in loops
    whose arrays the reverse sweep binds again, `remade` those of them that the reverse of an iteration allocates,
    `after` the statements whose adjoints run in the state that they leave, `halves` the calls whose adjoints are the
    sweeps of a function, of which the tapes are kept (`tapes` is their weight), `unread` those that the forward sweep
    leaves out, `between` the values that are computed again from what is recorded. `dtypes` are those of entries that
    take less than what is recorded, by its key, `exact` has the statements for whose sake floats are not rounded."""
    rerun: Mapping[int, IterationState] = field(default_factory=dict)
    values: dict[str, ReverseValue] = field(default_factory=dict)
    recorded: dict[str, ReverseValue] = field(default_factory=dict)
    stores: dict[str, Store] = field(default_factory=dict)
    early: dict[int, list[str]] = field(default_factory=dict)
    late: dict[tuple[int, int], list[str]] = field(default_factory=dict)
    reloaded: dict[str, AST] = field(default_factory=dict)
    shifted: dict[str, Shift] = field(default_factory=dict)
    reversed: set[int] = field(default_factory=set)
    forwards: frozenset[int] = frozenset()
    reallocated: set[int] = field(default_factory=set)
    remade: set[int] = field(default_factory=set)
    after: frozenset[int] = frozenset()
    weight: int = 0
    dtypes: dict[str, str] = field(default_factory=dict)
    exact: dict[str, AST] = field(default_factory=dict)
    halves: frozenset[int] = frozenset()
    unread: frozenset[int] = frozenset()
    tapes: int = 0
    readers: dict[str, list[AST]] = field(default_factory=dict)
    between: set[str] = field(default_factory=set)

    def concerned_loops(self, structure: ProgramStructure) -> set[int]:
        """The loops in which something that is recorded is bound, stored, computed again or read: no other can lower
        the weight by running again."""
        values = [self.values[key] for key in self.between | self.recorded.keys() if key in self.values]
        found = [s.statement for s in self.stores.values()] + [s for read in self.readers.values() for s in read]
        found += [s for v in values for s in (v.home, *v.bindings)]
        return {id(x) for s in found for x in (s, *structure.place(s).loops)}

    @property
    def snapshots(self) -> list[Snapshot]:
        """What is kept of the arrays that flow between the iterations of loops that run again."""
        return [Snapshot(state.loop, array) for state in self.rerun.values() for array in state.flowing]


@dataclass
class RecordingProblem:
    """The tables, what the adjoint of each statement reads, what each statement stores, whether its adjoint runs in the
    state that it leaves, and whether a call fills an array, each time the same elements, before it reads it; the
    statements whose stores nothing reads (`unread`) do not run."""
    structure: ProgramStructure
    dependence: Dependence
    active: Callable[[AST], bool]
    uses: Callable[[AST], OperandUses]
    writes: Callable[[AST], list[AST]]
    after: Callable[[AST], bool] = reads_own_result
    refills: Callable[[AST, str], bool] = lambda statement, array: False
    unread: frozenset[int] = frozenset()

    def stores(self, statement: AST) -> list[AST]:
        """What the forward sweep stores at a statement."""
        return [] if id(statement) in self.unread else self.writes(statement)

    @cached_property
    def reverse_values(self) -> ReverseValues:
        """The values of the function, by name and place of use."""
        return ReverseValues(self.structure)

    @cached_property
    def loads(self) -> dict[str, list[tuple[StatementPlace, AST]]]:
        """The references that read an array, allocations apart, by its name, with where they are."""
        places = [p for p in self.structure.places.values() if not is_allocation(p.statement)]
        return by_key(((p, x) for p in places for x in reads(p.statement, self.structure.typing)),
                      lambda found: base_name(found[1]))

    @cached_property
    def adjoint_loads(self) -> dict[str, list[tuple[StatementPlace, AST]]]:
        """The references that adjoints read an array by, by its name, with the places of their statements."""
        places = [p for p in self.structure.places.values() if self.active(p.statement)]
        return by_key(((p, x) for p in places for x in self.uses(p.statement).loads),
                      lambda found: base_name(found[1]))


def by_key(items: Iterable[T], key: Callable[[T], K]) -> dict[K, list[T]]:
    """The items by what `key` says of them, in their order.

    >>> by_key([1, 2, 3], lambda n: n % 2)
    {1: [1, 3], 0: [2]}
    """
    found: dict[K, list[T]] = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return found


def subscripts(statement: AST) -> AST:
    place = targets(statement)[0]
    assert isinstance(place, Subscript)
    return place.slice


def reads(statement: AST, typing: Typing) -> list[AST]:
    """The array references that a statement itself reads; an increment does not read what it adds to."""
    found: list[AST] = []
    for head in heads(statement):
        if isinstance(head, (Assign, AugAssign)):
            found += loads_of(head.value, typing)
            for target in targets(head):
                found += loads_of(target.slice, typing) if isinstance(target, Subscript) else []
        elif isinstance(head, Expr) and isinstance(head.value, Call):
            found += loads_of(head.value, typing)
        elif not isinstance(head, Expr):
            found += loads_of(head, typing)
    return found
