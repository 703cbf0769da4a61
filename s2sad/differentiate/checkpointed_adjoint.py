"""checkpointed_adjoint: the adjoint of an outlined loop, in two halves. The first runs the loop and keeps the state of
some steps; the second takes the steps backwards, each in the state before it: where that is not kept, the steps from
the last one that is are run again, and states are kept on the way.

    def f_k_loop_forward(n, u):                     def f_k_loop_adjoint(n, u, u_bar, kept):
        ...                                             held, count, trips, u_snapshots = kept
        for k in range(n):                              for k in range(trips - 1, -1, -1):
            if k == following or k == trips - 1:            u_again[:] = u_snapshots[count - 1]
                held[count] = k                             for again in range(held[count - 1], k):
                u_snapshots[count] = u                          ... keep some ...
                count += 1                                      f_k_step(again, u_again)
                ...                                         f_k_step_adjoint(k, u_again, u_bar)
            f_k_step(k, u)                                  ...
        return (held, count, trips, u_snapshots)

A state lies in a row of its arrays' snapshots, in memory or in a file; there is one row more than states are kept, for
the last. Of an array of which steps change a known region alone (`stored_regions`) this is kept, and steps run again in
the array itself: `u[2:m] = u_snapshots[count - 1]`. Which states are kept is for `runtime.revolve` to say where the
number of steps is known, at the least number of runs; else every second, fourth, ... one is, and what is left is kept
on the way back.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from s2sad.analyze.callee_derivatives import CalleeDerivative
from s2sad.analyze.dependence import range_parts
from s2sad.analyze.request import DerivativeRequest
from s2sad.differentiate.derivative import Derivative
from s2sad.differentiate.reversed_loops import constant_integer
from s2sad.differentiate.shadows import with_shadows
from s2sad.infer.inference import Typing
from s2sad.infer.types import INT, UNKNOWN, Type, array
from s2sad.liveness import base_name
from s2sad.naming import Names
from s2sad.normalize.calls.outlining import OutlinedLoop
from s2sad.program import Table
from s2sad.tree import (
    AST, Add, And, BoolOp, Break, Call, Eq, Expr, For, FunctionDef, If, Mod, Mult, Or, Return, Slice, Sub, While, add,
    assign, attribute, augment, binary, call, comment, compare, const, copy, counted_for, function, index, name, names,
    rename, sub, substitute, tuple_of,
)


@dataclass(frozen=True)
class StepDerivative:
    """What is known of a step: its parameters and their types, the positions of its active arguments and results, its
    adjoint (None if nothing is active), and what is kept of its state: of arrays the `regions` that steps change."""
    parameters: tuple[str, ...]
    arguments: tuple[int, ...]
    results: tuple[int, ...]
    adjoint: CalleeDerivative | None
    state: tuple[str, ...]
    regions: Mapping[str, tuple[AST, ...]] = field(default_factory=dict)


class CheckpointedAdjoint:
    """The two halves of one loop's adjoint; `parameters` are those of the loop's function."""

    def __init__(self, loop: OutlinedLoop, step: StepDerivative, parameters: Sequence[str],
                 request: DerivativeRequest, typing: Typing, free: Names):
        self.loop, self.step, self.parameters = loop, step, parameters
        self.request, self.typing, self.free = request, typing, free
        self.stored = {n: self.new(f"{n}_snapshots", array(typing.table[n].dtype, typing.table[n].rank + 1))
                       for n in step.state}
        self.again = {n: self.new(f"{n}_again", typing.table[n]) for n in step.state
                      if typing.table[n].is_array and n not in step.regions}
        self.held_steps = self.bookkeeping()
        self.trips = self.new("trips", INT)
        self.most = loop.snapshots.count + 1    # states; one is that before the last step, where that is known
        self.places = self.most - loop.is_counted
        self.kept = self.new("kept", UNKNOWN)
        self.counter = loop.loop.target.id if isinstance(loop.loop, For) else ""
        self.plain = isinstance(loop.loop, For) and loop.is_counted and from_zero(loop.loop)
        self.trip = self.counter if self.plain else self.new("trip", INT)
        self.shadows: dict[str, str] = {}

    def new(self, hint: str, kind: Type) -> str:
        return self.typing.declare(self.free.fresh(hint), kind)

    def part(self, value: str, arrays: Mapping[str, str] = MappingProxyType({})) -> AST:
        """What is kept of a value that lies in `arrays`."""
        region = self.step.regions.get(value)
        return name(arrays.get(value, value)) if region is None else index(name(value), *map(copy, region))

    def bookkeeping(self) -> list[str]:
        """Names of what is known of the states that are kept; those that the second half is given are returned."""
        self.held, self.count, self.following, self.gap = (self.new(n, t) for n, t in (
            ("held", array("int64", 1)), ("count", INT), ("following", INT), ("gap", INT)))
        return [self.held, self.count] if self.stored else []

    def constants(self) -> dict[str, Table]:
        """The tables that the text holds."""
        return {}

    # -- forward -----------------------------------------------------------------------------------------------------

    def forward(self, title: str) -> FunctionDef:
        """The first half: it returns what the loop returns, and what it keeps."""
        body = self.stateless() if not self.stored else self.counted() if self.loop.is_counted else self.uncounted()
        kept = tuple_of(*map(name, (*self.held_steps, self.trips, *self.stored.values())))
        unset = [assign(n, const(self.typing.table[n].zero)) for n in self.loop.outputs if n not in self.parameters]
        returned: AST = tuple_of(*map(name, self.loop.outputs), kept) if self.loop.outputs else kept
        return function(title, list(self.parameters), [*unset, *body, Return(returned)])

    def stateless(self) -> list[AST]:
        """A loop of which the steps' adjoints read nothing that steps change: none is run again."""
        body: list[AST] = [copy(self.loop.step)]
        if self.loop.is_counted:
            return [assign(self.trips, call("builtins.len", copy(self.loop.loop.iter))), self.around(body)]
        return [assign(self.trips, const(0)), self.around([*body, *self.next_trip()])]

    def next_trip(self) -> list[AST]:
        """The end of a trip, which may be the last one."""
        counted = augment(self.trips, Add(), const(1))
        return [counted, If(name(self.loop.left), [Break()], [])] if self.loop.left else [counted]

    def counted(self) -> list[AST]:
        """A loop whose number of steps is known: as many states are kept as there is room for, where Revolve says so,
        and the last one beside them."""
        loop = self.loop.loop
        last = BoolOp(Or(), [compare(name(self.trip), Eq(), name(self.following)),
                             compare(name(self.trip), Eq(), sub(name(self.trips), const(1)))])
        body: list[AST] = [If(last, self.keep(self.trip, name(self.trips)), []), copy(self.loop.step)]
        rows = call("builtins.min", const(self.most), name(self.trips))
        before: list[AST] = [assign(self.trips, call("builtins.len", copy(loop.iter))), self.allocated_steps(rows),
                             *self.allocated(rows), assign(self.count, const(0)), assign(self.following, const(0))]
        return [*before, *self.with_trips(body)]

    def with_trips(self, body: list[AST]) -> list[AST]:
        """The loop over a body, with its trips counted."""
        if self.plain:
            return [self.around(body)]
        return [assign(self.trip, const(0)), self.around([*body, augment(self.trip, Add(), const(1))])]

    def uncounted(self) -> list[AST]:
        """A loop whose number of steps shows in the end."""
        turn = compare(binary(name(self.trips), Mod(), name(self.gap)), Eq(), const(0))
        crowded = BoolOp(And(), [turn, call("runtime.crowded", name(self.trips), name(self.gap), const(self.places))])
        rows = [self.held, *self.stored.values()]
        thinned: list[AST] = [Expr(call("runtime.thin", name(r), name(self.count))) for r in rows[:-1]]
        thinned += [assign(self.count, call("runtime.thin", name(rows[-1]), name(self.count))),
                    assign(self.gap, binary(const(2), Mult(), name(self.gap)))]
        body: list[AST] = [While(crowded, thinned, []), If(copy(turn), self.keep(self.trips, None), []),
                           copy(self.loop.step), *self.next_trip()]
        zeros = [assign(n, const(0)) for n in (self.count, self.trips)]
        return [self.allocated_steps(self.rows()), *self.allocated(self.rows()), *zeros, assign(self.gap, const(1)),
                self.around(body)]

    def around(self, body: list[AST]) -> AST:
        loop = self.loop.loop
        if isinstance(loop, For):
            return For(loop.target, copy(loop.iter), body, [], None)
        return While(copy(loop.test), body, [])

    def allocated_steps(self, rows: AST) -> AST:
        """The array of the steps before which states are kept."""
        return assign(self.held, call("numpy.empty", copy(rows), name("numpy.int64")))

    def allocated(self, rows: AST) -> list[AST]:
        """The arrays of snapshots."""
        made: list[AST] = []
        for value, snapshots in self.stored.items():
            kind = self.typing.table[value]
            if kind.is_array and self.loop.snapshots.on_disk is not None:
                made.append(assign(snapshots, call("runtime.on_disk", self.part(value), copy(rows),
                                                   const(self.loop.snapshots.on_disk))))
                continue
            size = copy(rows) if not kind.is_array else binary(
                tuple_of(copy(rows)), Add(), attribute(self.part(value), "shape"))
            dtype = [] if kind.dtype == "float64" else [
                name("numpy.bool_" if kind.dtype == "bool" else f"numpy.{kind.dtype}")]
            made.append(assign(snapshots, call("numpy.empty", size, *dtype)))
        return made

    def rows(self) -> AST:
        """How many states there is room for, in the names of the loop's function."""
        most = const(self.most)
        if not self.loop.is_counted:
            return most
        return call("builtins.min", most, call("builtins.len", copy(self.loop.loop.iter)))

    def keep(self, trip: str, end: AST | None, arrays: Mapping[str, str] = MappingProxyType({})) -> list[AST]:
        """The state before a step is kept, that lies in `arrays`; before `end` another may be, if that is known."""
        made: list[AST] = [assign(index(name(self.held), name(self.count)), name(trip))]
        made += [assign(index(name(s), name(self.count)), self.part(n, arrays)) for n, s in self.stored.items()]
        made.append(augment(self.count, Add(), const(1)))
        if end is not None:
            made.append(assign(self.following, self.next_kept(name(trip), end)))
        return made

    def next_kept(self, start: AST, end: AST) -> AST:
        return call("runtime.revolve", start, end, sub(const(self.places), name(self.count)))

    # -- reverse -----------------------------------------------------------------------------------------------------

    def reverse(self, title: str) -> Derivative:
        """The second half: it takes what the first one keeps as its last argument."""
        signature, before, after = self.signature()
        body = self.step_adjoint() if not self.stored else [
            comment("the state before this step, by the steps from the last one that is kept"),
            *self.state_before(), *self.step_adjoint(), *self.state_after()]
        kept = tuple_of(*map(name, (*self.held_steps, self.trips, *self.stored.values())))
        backwards = counted_for(self.trip, [sub(name(self.trips), const(1)), const(-1), const(-1)], body)
        returned = [p for p in self.request.wrt if self.typing.table[p].is_number]
        values: list[AST] = [name(self.shadows[p]) for p in returned]
        allocated = [assign(again, call("numpy.empty_like", name(n))) for n, again in self.again.items()]
        made = function(title, [n for n, _, _ in signature], [
            assign(kept, name(self.kept)), *before, *allocated, backwards, *after,
            *([Return(tuple_of(*values))] if values else [])])
        rows = self.rows() if isinstance(self.loop.loop, For) else call(
            "builtins.min", const(self.most), name(self.trips))
        return Derivative(made, self.shadows, signature, returned, rows=rows,
                          snapshots={s: self.part(n) for n, s in self.stored.items()}, trips=self.trips)

    def state_before(self) -> list[AST]:
        """The state before a step, by the steps from the last state that is kept; others are kept on the way."""
        again = self.new("again", INT)
        last = index(name(self.held), sub(name(self.count), const(1)))
        end = add(name(self.trip), const(1))
        run = [If(compare(name(again), Eq(), name(self.following)), self.keep(again, copy(end), self.again), []),
               self.called(name(again))]
        return [*self.loaded(sub(name(self.count), const(1))), assign(self.following, self.next_kept(copy(last), end)),
                counted_for(again, [copy(last), name(self.trip)], run)]

    def state_after(self) -> list[AST]:
        """A state is given up when its step is reversed."""
        last = index(name(self.held), sub(name(self.count), const(1)))
        return [If(compare(last, Eq(), name(self.trip)), [augment(self.count, Sub(), const(1))], [])]

    def loaded(self, row: AST) -> list[AST]:
        """The state of a row, where steps run again."""
        return [assign(index(name(self.again[n]), Slice(None, None, None)) if n in self.again else
                       self.part(n) if n in self.step.regions else n, index(name(s), copy(row)))
                for n, s in self.stored.items()]

    def signature(self) -> tuple[list[tuple[str, str, str]], list[AST], list[AST]]:
        """The parameters; the shadows that are bound before the steps, and what is added behind them."""
        signature: list[tuple[str, str, str]] = []
        before: list[AST] = []
        after: list[AST] = []
        self.bars: dict[str, str] = {}      # of what a step takes and gives
        for parameter in self.parameters:
            signature.append((parameter, "primal", parameter))
            kind, carried = self.typing.table[parameter], parameter in self.loop.carried
            if kind.is_inexact and parameter in {*self.request.wrt, *self.request.of}:
                own = self.new(f"{parameter}_first_bar" if carried else f"{parameter}_bar", kind)
                self.shadows[parameter] = own
                signature.append((own, "shadow", parameter))
                if not carried:
                    self.bars[parameter] = own
        seeded = {int(o.split()[1]) for o in self.request.of if o.startswith("return ")}
        for number, output in enumerate(self.loop.outputs):
            if number in seeded:
                self.bars[output] = self.new(f"{output}_bar", self.typing.table[output])
                signature.append((self.bars[output], "seed", f"return {number}"))
        for used in self.active():
            if used not in self.bars:
                kind = self.typing.table[used]
                self.bars[used] = self.new(f"{used}_bar", kind)
                before.append(assign(self.bars[used], call("numpy.zeros_like", name(used)) if kind.is_array
                                     else const(0.0)))
        for parameter in self.loop.carried:
            if parameter in self.shadows and parameter in self.bars:
                after.append(augment(self.shadows[parameter], Add(), name(self.bars[parameter])))
        signature.append((self.kept, "kept", self.kept))
        return signature, before, after

    def active(self) -> list[str]:
        """The names that are active in a step."""
        return [*(self.step.parameters[k] for k in self.step.arguments), *(
            self.loop.results[k] for k in self.step.results if k < len(self.loop.results))]

    def called(self, trip: AST) -> AST:
        """A step, run again in arrays of its own."""
        step = copy(self.loop.step)
        step.value = rename(self.with_counter(step.value, trip), self.again)
        return step

    def with_counter(self, called: Call, trip: AST) -> Call:
        """A call with what the loop's counter is in a trip."""
        if not self.counter or self.counter not in names(called.args):
            return called
        return substitute(called, {self.counter: value_in_trip(self.loop.loop, trip)})

    def step_adjoint(self) -> list[AST]:
        """The adjoint of a step, in the state before it."""
        callee = self.step.adjoint
        if callee is None:
            return []
        original: Call = self.loop.step.value

        def shadow(argument: AST) -> AST:
            return const(0.0) if base_name(argument) in self.loop.carried else name(self.bars[base_name(argument)])
        args: list[AST] = [rename(a, self.again) for a in with_shadows(original, callee, shadow)]
        args += [name(self.bars[self.loop.results[k]]) for k in callee.seeds]
        targets = [self.bars[self.step.parameters[k]] for k in callee.returns]
        called = self.with_counter(call(callee.name, *args), name(self.trip))
        made: list[AST] = [assign(tuple_of(*map(name, targets)), called) if targets else Expr(called)]
        made += [assign(self.bars[self.loop.results[k]], const(0.0)) for k in callee.seeds
                 if self.bars[self.loop.results[k]] not in targets]
        return made


def from_zero(loop: For) -> bool:
    """Whether a loop counts its trips."""
    start, _, step = range_parts(loop)
    return constant_integer(start) == 0 and step == 1


def value_in_trip(loop: AST, trip: AST) -> AST:
    """The counter of a loop in a trip, which is counted from 0."""
    start, _, step = range_parts(loop)
    size = const(step) if isinstance(step, int) else copy(step)
    moved = trip if step == 1 else binary(trip, Mult(), size)
    return moved if constant_integer(start) == 0 else add(copy(start), moved)
