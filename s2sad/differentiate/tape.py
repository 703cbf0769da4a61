"""tape: for every recorded value the local names that hold it between the sweeps.

A push outside of loops is a number. Inside loops with known trips the stack is an array with one index a loop,
indexed by the counters. Elsewhere the array doubles when it is full: inside one loop it is indexed by the number of the
iteration, inside several by an integer of its own.

    u_stack = np.empty((len(range(steps)),) + u.shape)     x_stack, trips = np.empty(64), 0
    for s in range(steps):                                 while ...:
        u_stack[s] = u                                         x_stack = grow(x_stack, trips)
                                                               x_stack[trips] = x
                                                               ...
                                                               trips += 1

Room for what innermost loops push is made in front of them where their trips are known there (`stack_reservation`).
"""
from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from s2sad.liveness import base_name
from s2sad.analyze.reallocated_arrays import is_reallocated
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.trip_counts import counter, invariant_trip_counts
from s2sad.differentiate.trip_counters import TripCounters
from s2sad.differentiate.ragged_stacks import RecordedRegion, push_region, pop_region
from s2sad.differentiate.stack_reservation import Reservation, reservation
from s2sad.infer.inference import Typing
from s2sad.infer.types import INT, UNKNOWN, Type, array
from s2sad.naming import Names
from s2sad.tree import (
    AST, Add, BinOp, Constant, For, Gt, IfExp, Name, Sub, Subscript, While, add, assign, augment, call, compare, const,
    copy, index, indices, name, sub, tuple_of,
)

_FIRST = 64


@dataclass
class Stack:
    """One stack: its array, what indexes it where it is popped (`counters`) and pushed (`pushed`, if that differs) or
    else the integer that does (`top`), what is recorded (`value`) and what lies in one entry (`kind`, which may be
    narrower; an array type with its `shape`), and for reports how many entries each loop makes (`sizes`; none known if
    it grows). A `ragged` stack has the elements of arrays of several sizes one after the other; one with a
    `reservation` grows in front of these loops."""
    array: str
    value: Type = UNKNOWN
    top: str = ""
    loops: tuple[AST, ...] = ()
    counters: tuple[AST, ...] = ()
    pushed: AST | None = None
    grows: bool = False
    kind: Type = UNKNOWN
    shape: AST | None = None
    sizes: tuple[AST, ...] = ()
    ragged: bool = False
    reservation: Reservation | None = None


@dataclass
class Tape:
    """All stacks of a function; `allocations` by the id of the loop before which they stand, `dtypes` those of entries
    that are narrower than what is recorded, by the key of their stack."""
    structure: ProgramStructure
    typing: Typing
    free: Names
    rerun: Collection[int]
    counting: TripCounters
    dtypes: Mapping[str, str]
    stacks: dict[str, Stack] = field(default_factory=dict)
    allocations: dict[int, list[AST]] = field(default_factory=dict)

    def stack(self, key: str, base: str, kind: Type, inside: tuple[AST, ...], shape: AST | None,
              carried: bool = False) -> Stack:
        """The stack of a value of type `kind` (an array type with its `shape`) pushed inside these loops and branches,
        a `carried` one where an iteration begins."""
        if key not in self.stacks:
            self.stacks[key] = self._make(key, base, kind, inside, shape, carried)
        return self.stacks[key]

    def content_stack(self, key: str, place: AST, inside: tuple[AST, ...], shape: AST | None) -> Stack:
        """The stack of the content that a store overwrites: an element, or a region of this shape."""
        kind, array = self.typing.of(place), base_name(place)
        inner, home = self._homes(_loops(inside), carried=False)
        if not kind.is_array or not inner or not is_reallocated(self.structure, array, home[0]):
            return self.stack(key, array, kind, inside, shape)
        if key not in self.stacks:
            self.stacks[key] = self._make(key, array, Type("number", kind.dtype), inside, None, ragged=True)
            self.stacks[key].shape = shape
        return self.stacks[key]

    def _homes(self, loops: tuple[AST, ...], carried: bool) -> tuple[tuple[AST, ...], tuple[AST, ...]]:
        """The loops in each iteration of which a stack gets an entry, and the one before which it is made. What is
        `carried` lies there also if the last one runs again."""
        again = [k for k, loop in enumerate(loops[:-1] if carried else loops) if id(loop) in self.rerun]
        return loops[again[-1] + 1 if again else 0:], loops[again[0] if again else 0:][:1]

    def _make(self, key: str, base: str, value: Type, inside: tuple[AST, ...], shape: AST | None,
              carried: bool = False, ragged: bool = False) -> Stack:
        inner, home = self._homes(_loops(inside), carried)
        kind = replace(value, dtype=self.dtypes.get(key, value.dtype)) if inner or value.is_array else value
        made = Stack(self.free.fresh(f"{base}_stack" if inner else f"{base}_before"), value, loops=inner, kind=kind,
                     shape=shape, ragged=ragged)
        if not inner:
            self.typing.declare(made.array, kind)
            return made
        sizes = None if ragged else invariant_trip_counts(self.structure, inner, home[0])
        if sizes is not None:
            made.counters = tuple(counter(loop) for loop in inner)
            made.sizes = tuple(sizes)
            allocated = [self._allocate(made.array, kind, sizes, shape)]
        else:
            if not ragged and not any(id(loop) in self.rerun for loop in inner):
                made.reservation = reservation(self.structure, inside, inner)
            allocated = [self._allocate(made.array, kind, [const(_FIRST)], shape),
                         *self._growing(made, base, carried)]
        self.typing.declare(made.array, array(kind.dtype, kind.rank + max(1, len(made.counters))))
        self.allocations.setdefault(id(home[0]), []).extend(allocated)
        return made

    def _growing(self, made: Stack, base: str, carried: bool) -> list[AST]:
        """Sets what indexes a stack that grows; the statements that begin it."""
        made.grows = True
        if made.reservation is not None and len(made.reservation.loops) == len(made.loops):
            made.counters = (made.reservation.offset(),)
            return []
        single = len(made.loops) == 1 and not made.ragged
        found = self.counting.iteration(made.loops[0], carried) if single else None
        if found is not None:
            made.pushed, made.counters = found[0], (found[1],)
            return []
        made.top = self.typing.declare(self.free.fresh(f"{base}_top"), INT)
        return [assign(made.top, const(0))]

    def _allocate(self, target: str, kind: Type, sizes: list[AST], shape: AST | None) -> AST:
        dtype = [] if kind.dtype == "float64" else [name("numpy.bool_" if kind.dtype == "bool"
                                                         else f"numpy.{kind.dtype}")]
        size: AST = sizes[0] if len(sizes) == 1 and shape is None else tuple_of(*sizes)
        if shape is not None:
            size = BinOp(tuple_of(*sizes), Add(), shape)
        return assign(target, call("numpy.empty", size, *dtype))

    # -- statements --------------------------------------------------------------------------------------------------

    def push(self, stack: Stack, value: AST) -> list[AST]:
        if stack.ragged:
            return push_region(stack.array, stack.top, self.region(value))
        whole = self.typing.of(value).is_array
        if not stack.counters and not stack.top:
            return [assign(stack.array, _copied(stack, value) if whole else value)]
        place = name(stack.top) if stack.top else stack.pushed
        if place is None or stack.reservation is not None:
            return [assign(self.cell(stack), value)]
        return [assign(stack.array, call("runtime.grow", name(stack.array), copy(place))),
                assign(index(name(stack.array), copy(place)), value),
                *([augment(stack.top, Add(), const(1))] if stack.top else [])]

    def previous(self, stack: Stack, first: AST) -> AST:
        """What an indexed stack holds of the iteration before, or `first` in the first one."""
        last = stack.counters[-1]
        cell = index(name(stack.array), *map(copy, stack.counters[:-1]), sub(copy(last), const(1)))
        return IfExp(compare(copy(last), Gt(), const(0)), widened(stack, cell), first)

    def cell(self, stack: Stack) -> AST:
        if not stack.counters and not stack.top:
            return name(stack.array)
        top = add(name(stack.top), stack.reservation.offset()) if stack.reservation else name(stack.top)
        return index(name(stack.array), *(map(copy, stack.counters) if stack.counters else [top]))

    def pop(self, stack: Stack, target: AST) -> list[AST]:
        entry: AST = self.region(target).size if stack.ragged else const(1)
        made: list[AST] = [augment(stack.top, Sub(), entry)] if stack.top and stack.reservation is None else []
        return [*made, *self.read(stack, target)]

    def reserved_in_front(self, loop: AST) -> list[tuple[Stack, Reservation]]:
        """The stacks that get room for their entries in front of a loop."""
        return [(s, s.reservation) for s in self.stacks.values()
                if s.reservation is not None and s.reservation.loops[0] is loop]

    def reserve(self, loop: AST) -> tuple[list[AST], list[AST]]:
        """What stands in front of a loop and behind it in the forward sweep, for the stacks that have room for all of
        its entries."""
        found = self.reserved_in_front(loop)
        return ([assign(s.array, call("runtime.grow", name(s.array), r.last(name(s.top) if s.top else None)))
                 for s, r in found], [augment(s.top, Add(), r.entries) for s, r in found if s.top])

    def release(self, loop: AST) -> list[AST]:
        """What stands in front of a loop in the reverse sweep."""
        return [augment(s.top, Sub(), r.entries) for s, r in self.reserved_in_front(loop) if s.top]

    def runs_backwards(self, loop: AST) -> bool:
        """Whether the reverse sweep has to pop the entries of a loop from the last one on."""
        return any(s.top and any(x is loop for x in s.loops) and not (
            s.reservation and any(x is loop for x in s.reservation.loops)) for s in self.stacks.values())

    def read(self, stack: Stack, target: AST) -> list[AST]:
        """The last entry into the target, left where it is."""
        if stack.ragged:
            return [pop_region(stack.array, stack.top, self.region(target))]
        cell = self.cell(stack)     # a store into an array converts by itself
        return [assign(target, widened(stack, cell) if isinstance(target, Name) else cell)]

    def region(self, place: AST) -> RecordedRegion:
        """The array or row that an entry of a ragged stack is of."""
        base = place.value if isinstance(place, Subscript) else place
        kept = [] if isinstance(place, Name) else explicit_subscripts(place)
        counters = [self.typing.declare(self.free.fresh(c), INT)
                    for c in ("i", "j", "k", "l", "m", "o")[:self.typing.of(place).rank]]
        return RecordedRegion(base, tuple(kept), tuple(counters))


def widened(stack: Stack, entry: AST) -> AST:
    """An entry of a stack as the number that was recorded: arithmetic goes on in its dtype."""
    return entry if stack.kind == stack.value else call(f"numpy.{stack.value.dtype}", entry)


def _copied(stack: Stack, array: AST) -> AST:
    """A copy of an array with the stack's dtype."""
    return call("numpy.copy", array) if stack.kind == stack.value else call(
        "numpy.asarray", array, name(f"numpy.{stack.kind.dtype}"))


def _loops(inside: tuple[AST, ...]) -> tuple[AST, ...]:
    return tuple(s for s in inside if isinstance(s, (For, While)))


def explicit_subscripts(place: Subscript) -> list[AST]:
    """The subscripts of an element or a row; none of `x[...]`."""
    return [s for s in indices(place) if not (isinstance(s, Constant) and s.value is Ellipsis)]
