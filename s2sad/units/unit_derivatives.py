"""Units are differentiated: DERIVATIVES on a unit in normal form, then `simplify`'s lists, once for each request."""
from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from s2sad import simplify
from s2sad.analyze import ACTIVITY, PASSES as ANALYSES
from s2sad.analyze.activity import Activity, activity_of
from s2sad.analyze.kept_tapes import array_weight
from s2sad.analyze.live_state import live_state
from s2sad.analyze.callee_derivatives import ActivityPattern, CalleeDerivative, activity_pattern
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.recording_plan import RecordingPlan
from s2sad.analyze.request import DerivativeRequest
from s2sad.analyze.stored_regions import Callee, stored_region
from s2sad.analyze.tape_entries.decision_reads import DecisionReads, deciding_parameters
from s2sad.analyze.unbounded_values import UnboundedValues, unbounded_values_of
from s2sad.analyze.work_arrays import refills
from s2sad.differentiate import PASSES as DIFFERENTIATION
from s2sad.differentiate.augmented_primal import BothSweeps, TapeEntry, with_kept_tape
from s2sad.differentiate.checkpointed_adjoint import CheckpointedAdjoint, StepDerivative
from s2sad.differentiate.scheduled_adjoint import ScheduledAdjoint
from s2sad.differentiate.context import DifferentiationContext
from s2sad.differentiate.derivative import Derivative
from s2sad.differentiate.implicit import Residual, solution_of, implicit_refusal
from s2sad.differentiate.user_derivative import user_derivative
from s2sad.form import verify
from s2sad.infer.inference import Typing
from s2sad.infer.types import FLOAT, UNKNOWN, Type
from s2sad.blocks import returned_values
from s2sad.liveness import Accesses, base_name, targets
from s2sad.naming import Names
from s2sad.normalize.calls.global_arrays import hidden_arrays
from s2sad.normalize.calls.outlining import OutlinedLoop
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.passes import Passes, run
from s2sad.program import Economy, Table, TapeDtype
from s2sad.simplify import DerivativeContext, Effect, Effects
from s2sad.simplify.wide_accumulators import uses_float32
from s2sad.tree import (
    AST, Assert, Assign, Call, Constant, For, FunctionDef, Name, Subscript, While, function, is_comment, user_call,
    walk, walk_statements,
)
from s2sad.units.normal_forms import NormalForms
from s2sad.units.unit import Unit

DERIVATIVES: Passes = (*ANALYSES, *DIFFERENTIATION)


@dataclass
class UnitDerivative:
    """A derivative: its function, its signature for callers, and the tables for reports."""
    callee: CalleeDerivative
    function: FunctionDef
    made: Derivative
    unit: Unit
    activity: Activity
    types: dict[str, Type]
    request: DerivativeRequest
    structure: ProgramStructure                     # of the tree that was differentiated, which the plan is for
    plan: RecordingPlan | None = None
    beside: tuple[FunctionDef, ...] = ()
    forward: FunctionDef | None = None              # the augmented primal, if `function` is the reverse sweep alone,
    tape: tuple[TapeEntry, ...] = ()                # which takes this first
    equal_sizes: tuple[AST, ...] = ()               # what is known there of the sizes of arrays
    kept: str = ""                                  # the tape as one value, of sweeps that a caller calls

    def called_halves(self, forward: FunctionDef, reverse: FunctionDef) -> tuple[FunctionDef, FunctionDef]:
        """The two sweeps as their callers call them."""
        return with_kept_tape(forward, reverse, len(self.unit.summary.results), self.tape, self.kept)

    @property
    def functions(self) -> tuple[FunctionDef, ...]:
        """The functions that it consists of."""
        return (self.function, *self.beside, *([self.forward] if self.forward else []))

    @property
    def mode(self) -> str:
        return "tangent" if self.plan is None else "adjoint"


@dataclass
class Units(NormalForms):
    """Everything made for one program and one engine."""
    derived: dict[tuple, UnitDerivative] = field(default_factory=dict)
    forwards: dict[str, str] = field(default_factory=dict)
    unbounded_tables: dict[str, UnboundedValues] = field(default_factory=dict)
    schedules: dict[str, Table] = field(default_factory=dict)     # tables that texts hold
    memory: Economy = "balanced"
    tape_dtype: TapeDtype = "float64"
    deciding: dict[str, frozenset[int]] = field(default_factory=dict)     # parameters by which units decide, by title

    def without_derivatives(self) -> Units:
        """The same units with nothing derived: no text depends on what was derived before it."""
        return replace(self, made=dict(self.made), titled=dict(self.titled), titles=self.titles.copy(),
                       effects=Effects(dict(self.effects.table)), derived={}, forwards={}, schedules={})

    def tables(self) -> dict[str, np.ndarray]:
        """The tables of schedules that the texts read, by name."""
        return {name: np.array(table) for name, table in self.schedules.items()}

    def derive(self, mode: str, unit: Unit, request: DerivativeRequest, flat: bool = False) -> UnitDerivative:
        key = (mode, unit.title, request, flat)
        if key not in self.derived:
            apart = request.split or request.halves
            others = sum(k[0] == mode and k[1] == unit.title and apart == (k[2].split or k[2].halves)
                         for k in self.derived)
            word = "reverse" if apart else mode
            title = self.titles.fresh(f"{unit.title}_{word}" + (f"_{others + 1}" if others else ""))
            if unit.loop is not None and mode == "adjoint":
                made = self._checkpointed(unit, unit.loop, request, title)
            elif unit.kernel.own is not None:
                made = self._user_derivative(mode, unit, request, title)
            else:
                made = self._differentiated(mode, unit, request, title, flat)
            self.derived[key] = made
        return self.derived[key]

    def keep_derived(self, entry: UnitDerivative) -> None:
        """Drops the derivatives that one does not call, directly or not: those that were weighed and not taken."""
        named = {f.name: key for key, d in self.derived.items() for f in d.functions}
        found: set[tuple] = set()
        waiting = [named[entry.function.name]]
        while waiting:
            if (key := waiting.pop()) not in found:
                found.add(key)
                mentioned = {n.id.removeprefix("user.") for f in self.derived[key].functions for n in walk(f.body)
                             if isinstance(n, Name)}
                waiting += [named[n] for n in mentioned & named.keys()]
        self.derived = {key: d for key, d in self.derived.items() if key in found}

    def activity(self, unit: Unit, request: DerivativeRequest) -> Activity:
        return activity_of(unit.function, unit.typing, set(request.wrt), set(request.of), self.call_edges)

    def fresh(self, unit: Unit) -> tuple[Typing, Names]:
        """Tables of their own for one derivative, so that its names do not depend on what was made before."""
        typing = unit.typing.copy()
        names = Names(unit.names.taken | set(unit.typing.table))
        names.hints = dict(unit.names.hints)
        return typing, names

    def _differentiated(self, mode: str, unit: Unit, request: DerivativeRequest, title: str,
                        flat: bool) -> UnitDerivative:
        """The derivative after the passes of all rooms."""
        typing, names = self.fresh(unit)
        context = DifferentiationContext(
            program=self.program, kernel=unit.kernel, names=names, engine=self.engine, watch=self.watch,
            request=request, mode=mode, calls=self, derive=self.callee_derivatives(mode), title=title,
            family=unit.family, flat=flat, memory=self.memory,
            tape_dtype=self.tape_dtype)
        context.typing = typing
        made = run(DERIVATIVES, unit.function, context)
        apart = request.split or request.halves
        return self._separated(unit, made, context) if apart else self._simplified(unit, made, context)

    def _checkpointed(self, unit: Unit, loop: OutlinedLoop, request: DerivativeRequest, title: str) -> UnitDerivative:
        """The adjoint of an outlined loop, in two halves."""
        typing, names = self.fresh(unit)
        context = DifferentiationContext(
            program=self.program, kernel=unit.kernel, names=names, engine=self.engine, watch=self.watch,
            request=request, mode="adjoint", calls=self, derive=self.callee_derivatives("adjoint"), title=title,
            family=unit.family)
        context.typing = typing
        run(ACTIVITY, unit.function, context)
        [statement] = [s for s in walk_statements(unit.function.body) if user_call(getattr(s, "value", None)) ==
                       loop.callee]
        pattern = activity_pattern(statement, typing, context.activity.active, context.unbounded.adjoint_boundary)
        adjoint = context.derive(pattern) if pattern.arguments or pattern.results else None
        step = self.titled[loop.callee]
        parameters = tuple(p.id for p in step.function.args.args)
        state = self._state(step, loop, adjoint)
        for name, kind in zip(parameters, step.types):
            if name not in typing.table:
                typing.declare(name, kind)
        found = StepDerivative(parameters, pattern.arguments, pattern.results, adjoint, state,
                               self._regions(step, loop, state))
        kind = ScheduledAdjoint if loop.snapshots.schedule is not None and state else CheckpointedAdjoint
        halves = kind(loop, found, [p.id for p in unit.function.args.args], request, typing, names)
        forward = halves.forward(self.titles.fresh(f"{unit.title}_forward"))
        made = halves.reverse(title)
        for half in (forward, made.function):
            self.effects.add(half, typing)
        self.schedules |= halves.constants()
        in_arrays = any(_is_of_arrays(s, step.typing.table) for s in step.function.body)
        made.again = adjoint is not None and self._runs_forwards(adjoint.name.removeprefix("user."), in_arrays)
        callee = replace(self._callee(made, request, typing), forward=f"user.{forward.name}",
                         results=len(loop.outputs))
        return UnitDerivative(callee, made.function, made, unit, context.activity, dict(typing.table), request,
                              context.structure, RecordingPlan(), (forward,))

    def _runs_forwards(self, title: str, in_arrays: bool) -> bool:
        """Whether a function is an adjoint that runs a part of its primal, or calls one, or is no adjoint; `in_arrays`
        if what numbers alone are made of does not count."""
        made = next((d for d in self.derived.values() if d.function.name == title), None)
        if made is None:
            unit = self.titled.get(title)
            return unit is None or not in_arrays or any(t.is_array for t in unit.types)
        if made.unit.kernel.own is not None or made.unit.loop is not None:
            return True
        body = made.function.body
        marks = [k for k, s in enumerate(body) if is_comment(s)]
        run = [s for s in body[:marks[-1] if marks else 0] if not (
            is_comment(s) or isinstance(s, Assert) or is_allocation(s) or _is_copy(s))]
        if in_arrays:
            run = [s for s in run if _is_of_arrays(s, made.types)]
        return bool(run) or any(self._runs_forwards(c, in_arrays) for n in walk(body) if (c := user_call(n)))

    def _state(self, step: Unit, loop: OutlinedLoop, adjoint: CalleeDerivative | None) -> tuple[str, ...]:
        """The parameters of a loop's step that are kept."""
        parameters = [p.id for p in step.function.args.args]
        changed = {parameters[k]: parameters[k] for k in step.summary.written}
        returned = returned_values(step.function.body)
        changed |= {n: value.id for n, value in zip(loop.results, returned) if n in loop.carried}
        needed: set[str] = set()
        for derived in self.derived.values():
            if derived.callee is adjoint:
                names = [n for n, _, _ in derived.made.parameters]
                needed = {names[k] for k in self.effects.table[derived.function.name].reads}
        effects = self.effects
        counter = loop.loop.target.id if isinstance(loop.loop, For) else ""
        accesses = Accesses(effects.writes, effects.pure, effects.unread)
        found = live_state(step.function, counter, changed, needed, accesses, self)
        return tuple(n for n in parameters if n in found)

    def _regions(self, step: Unit, loop: OutlinedLoop, state: tuple[str, ...]) -> dict[str, tuple[AST, ...]]:
        """The parts of arrays of a step's state that steps change, where not all of them may be."""
        counter = loop.loop.target.id if isinstance(loop.loop, For) else ""
        fixed = {p for p, t in zip((p.id for p in step.function.args.args), step.types) if t.is_number} - {
            counter, *loop.results}
        found = {n: stored_region(step.structure, n, fixed, self._stores_of) for n, t in zip(
            (p.id for p in step.function.args.args), step.types) if n in state and t.is_array}
        return {n: region for n, region in found.items() if region}

    def _stores_of(self, called: Call) -> Callee | None:
        """What a call stores into; None where its text does not say it."""
        unit = self.callee(called)
        return None if unit is None or unit.kernel.own is not None else Callee(unit.structure, unit.summary.written)

    def unbounded(self, called: Call) -> UnboundedValues | None:
        """What can be infinite or nan in a callee, whatever is active there."""
        unit = self.callee(called)
        if unit is None:
            return None
        if unit.title not in self.unbounded_tables:
            every = Activity(frozenset(unit.typing.table), frozenset(unit.typing.table), ())
            self.unbounded_tables[unit.title] = unbounded_values_of(unit.function, unit.typing, every, self.unbounded)
        return self.unbounded_tables[unit.title]

    def decides(self, called: Call) -> Collection[int]:
        """The positions of the floats on which the way of a callee hangs: a user's own derivative may ask any."""
        unit = self.callee(called)
        if unit is None or unit.kernel.own is not None or unit.kernel.residual:
            return range(len(called.args))
        if unit.title not in self.deciding:
            self.deciding[unit.title] = deciding_parameters(unit.function, DecisionReads(unit.typing, self, {}))
        return self.deciding[unit.title]

    def unsupported(self, called: Call, pattern: ActivityPattern, mode: str) -> str:
        """What a derivative of the user's own lacks for a call, in words; empty if nothing."""
        unit = self.callee(called)
        if unit is None or unit.kernel.own is None:
            return ""
        if not (pattern.arguments or pattern.results or self.solves_nothing(unit)):
            return ""
        wrong = self.refusal(unit, self.callee_request(pattern, mode), mode)
        return wrong and f"'{unit.kernel.own.title}' {wrong}"

    def solves_nothing(self, unit: Unit) -> bool:
        """Whether nothing that an implicit function stores or returns is the solution of its residual: it would have no
        derivative."""
        residual = self.residual(unit)
        return residual is not None and not solution_of(residual.parameters, unit.owner.written) and not any(
            t.is_float for t in unit.summary.results)

    def refusal(self, unit: Unit, request: DerivativeRequest, mode: str) -> str:
        """Why a call cannot have the derivative of the user's own, in words; empty if it can."""
        residual = self.residual(unit)
        if unit.pairs:
            return "is given one array twice, and writes it; no derivative of its own is for that"
        if residual is not None:
            return implicit_refusal(unit.owner, residual, request)
        entry = next(u for u in self.made.values() if u.kernel.name == self.program.entry)
        parameters = [p.id for p in entry.function.args.args]
        written = {parameters[k] for k in entry.summary.written}
        outside = [a for p, a in hidden_arrays(self.program).items() if p in unit.owner.types and p in written]
        if outside:
            return f"reads '{outside[0]}', an array of its module that is written; so may its own derivative, too late"
        return unit.owner.refusal(mode, request)

    def _user_derivative(self, mode: str, unit: Unit, request: DerivativeRequest, title: str) -> UnitDerivative:
        """The derivative that calls the user's."""
        made = user_derivative(unit.owner, self.residual(unit), mode, request, title, self.forwards.get(unit.title, ""),
                     self.titles.fresh)
        self.effects.table[title] = Effect(made.reads, made.writes, True, made.arrays)
        if made.callee.forward:
            plain, half = self.effects.table[unit.title], made.callee.forward.partition(".")[2]
            self.forwards[unit.title] = half
            self.effects.table[half] = Effect(plain.arrays, plain.writes, plain.pure, plain.arrays)
        return UnitDerivative(made.callee, made.made.function, made.made, unit, self.activity(unit, request),
                              made.types, request, unit.structure, RecordingPlan() if mode == "adjoint" else None,
                              made.beside)

    def residual(self, unit: Unit) -> Residual | None:
        """The residual of an implicit function, for its types; None for any other function."""
        title = unit.kernel.residual
        if not title:
            return None
        taken, types = self.program.kernels[title].parameters, unit.owner.types
        solution = solution_of(taken, unit.owner.written)
        first = types[solution] if solution else next((t for t in unit.summary.results if t.is_float), FLOAT)
        inner = self.unit(title, (first, *(types[p] for p in taken[1:])))
        written = frozenset(taken[k] for k in inner.summary.written)

        def derive(mode: str, wrt: tuple[str, ...], of: tuple[str, ...]) -> CalleeDerivative:
            return self.derive(mode, inner, DerivativeRequest(wrt, of, mode == "tangent"), mode == "tangent").callee
        return Residual(title, taken, inner.summary.results, written, derive)

    def _simplified(self, unit: Unit, function: FunctionDef, found: DifferentiationContext) -> UnitDerivative:
        """The derivative after the passes of `simplify`, with its signature for callers."""
        made, typing, plan, request = found.derivative, found.typing, found.plan, found.request
        function = self._shortened(unit, function, found, self._live_out(made, typing, plan is None))
        return UnitDerivative(self._callee(made, request, typing), function, made, unit, found.activity,
                              dict(typing.table), request, found.structure, plan)

    def _separated(self, unit: Unit, adjoint: FunctionDef, found: DifferentiationContext) -> UnitDerivative:
        """The two sweeps as two functions, each after the passes of `simplify`."""
        made, typing, parameters = found.derivative, found.typing, [p.id for p in unit.function.args.args]
        request, live_out = found.request, self._live_out(made, typing, False)
        given = [p for p in made.parameters if request.halves or p[1] != "primal"]
        accesses = Accesses(self.effects.writes, self.effects.pure, self.effects.unread)
        sweeps = BothSweeps(adjoint, parameters, [n for n, _, _ in given], live_out, accesses, typing)
        plain = self._shortened(unit, sweeps.reverse, found, live_out)
        tape = sweeps.tape(plain, self.effects.table[plain.name].writes)
        title = self.titles.fresh(f"{unit.title}_augmented")
        forward = sweeps.augmented(title, returned_values(unit.function.body), tape)
        forward = self._shortened(unit, forward, found, {p for p in parameters if typing.table[p].is_array})
        made.parameters = [*((e.name, "tape", e.name) for e in tape), *given]
        plain = function(plain.name, [n for n, _, _ in made.parameters], plain.body)
        derived = UnitDerivative(CalleeDerivative(f"user.{plain.name}", (), (), (), (), ()), plain, made, unit,
                                 found.activity, dict(typing.table), request, found.structure, found.plan, (), forward,
                                 tape, tuple(sweeps.equal_sizes([e.name for e in tape])))
        if request.halves:
            derived.callee = self._halves(derived, typing, sweeps)
        return derived

    def _halves(self, derived: UnitDerivative, typing: Typing, sweeps: BothSweeps) -> CalleeDerivative:
        """What callers must know of the two sweeps of a function, which they call."""
        plan, made = derived.plan, derived.made
        assert derived.forward is not None and plan is not None
        kept = typing.declare(Names(derived.types).fresh("kept"), UNKNOWN)
        derived.types[kept] = UNKNOWN
        derived.kept = kept
        for half in derived.called_halves(derived.forward, derived.function):
            self.effects.add(half, typing)
        signature = [p for p in made.parameters if p[1] != "tape"]
        found = self._callee(replace(made, parameters=signature), derived.request, typing)
        spares = sweeps.spares_runs(derived.tape, self.effects.writes)
        weight = plan.tapes + sum(array_weight(e.kind) for e in derived.tape)
        given = [p.id for p in sweeps.reverse.args.args]
        fixed = {*given, *(f"={p}" for p in given)}
        restored = {k for k, p in enumerate(derived.unit.function.args.args) if k in found.reads and refills(
            sweeps.reverse, p.id, fixed, self, last=False)}
        return replace(found, forward=f"user.{derived.forward.name}", results=len(derived.unit.summary.results),
                       reads=tuple(k for k in found.reads if k not in restored), after=True,
                       tape=weight if spares else 0)

    def _shortened(self, unit: Unit, function: FunctionDef, found: DifferentiationContext, live_out: set[str]
                   ) -> FunctionDef:
        """A function after the passes of `simplify`."""
        made, typing, plan = found.derivative, found.typing, found.plan
        context = DerivativeContext(
            program=self.program, kernel=unit.kernel, names=found.names, engine=self.engine, watch=self.watch,
            types=typing.table, effects=self.effects, live_out=live_out,
            adjoint=plan is not None, kernel_names=unit.family, has_float32=plan is not None and uses_float32(typing),
            shadows={s: p for p, s in made.shadows.items()},
            kept_names=set(unit.family) | {made.shadows[v] for v in unit.family if v in made.shadows})
        context.typing = typing
        function = run(simplify.LOWERED, function, context)
        context.family = {**unit.family, **{s: f"{unit.family.get(p, p)}_{'bar' if plan else 'dot'}"
                                            for p, s in made.shadows.items() if typing.table[s].is_number}}
        function = run(simplify.PASSES, function, context)
        made.sums |= set(context.sums)
        made.coalesced |= _widest(context.renamed, typing)
        self.effects.add(verify(function, "derivative", "simplify"), typing)
        return function

    def _callee(self, made: Derivative, request: DerivativeRequest, typing: Typing) -> CalleeDerivative:
        """What callers must know of a finished derivative."""
        parameters = made.parameters
        shadows = [k for k, (_, role, _) in enumerate(parameters) if role == "shadow"]
        order = [p for p, role, _ in parameters if role == "primal"]
        effect = self.effects.table[made.function.name]
        position = {n: k for k, (n, _, _) in enumerate(parameters)}
        return CalleeDerivative(
            f"user.{made.function.name}", tuple(order.index(parameters[k][2]) for k in shadows),
            tuple(int(o.split()[1]) for o in request.of if o.startswith("return ")),
            tuple(order.index(p) for p in request.wrt if typing.table[p].is_number),
            tuple(k for k, p in enumerate(order) if position[p] in effect.reads),
            tuple(k for k, p in enumerate(order) if position[p] in effect.writes))

    def _live_out(self, made: Derivative, typing: Typing, primals: bool) -> set[str]:
        """The arrays whose content the caller reads: the shadows, of a tangent the primals too."""
        return {n for n, role, _ in made.parameters if typing.table[n].is_array and (primals or role == "shadow")}

    def callee_derivatives(self, mode: str):
        def made(pattern: ActivityPattern) -> CalleeDerivative:
            unit = self.unit(pattern.kernel, pattern.types)
            return self.derive(mode, unit, self.callee_request(pattern, mode), mode == "tangent").callee
        return made

    def callee_request(self, pattern: ActivityPattern, mode: str) -> DerivativeRequest:
        """The request of a call for the derivative of its callee."""
        unit = self.unit(pattern.kernel, pattern.types)
        halves = pattern.halves and unit.kernel.own is None and not (unit.runs_once or unit.outlined or unit.pairs)
        parameters = [p.id for p in unit.function.args.args]
        arguments = tuple(parameters[k] for k in pattern.arguments)
        written = {parameters[k] for k in unit.summary.written}
        of = tuple(p for p in arguments if p in written) + tuple(f"return {k}" for k in pattern.results)
        return DerivativeRequest(arguments, of, mode == "tangent", pattern.unbounded if unit.kernel.own is None
                                 else frozenset(), unit.outlined and mode == "adjoint", halves=halves)


def _widest(renamed: Mapping[str, str], typing: Typing) -> dict[str, Type]:
    """For each name under which versions come the type that holds all of them."""
    found: dict[str, Type] = {}
    for old, new in renamed.items():
        kind, known = typing.table.get(old, UNKNOWN), found.get(new)
        if known is None or not (kind.is_number and known.is_number):
            found[new] = kind
        elif kind != known:
            found[new] = replace(kind, dtype=np.result_type(kind.dtype, known.dtype).name)
    return found


def _is_copy(statement: AST) -> bool:
    """Whether a statement stores into an array what there is, and computes nothing: it is no part of a step's work."""
    if isinstance(statement, For):
        return all(map(_is_copy, statement.body))
    value = statement.value if isinstance(statement, Assign) and isinstance(targets(statement)[0], Subscript) else None
    return isinstance(value, (Name, Constant, Subscript)) and bool(base_name(value) or isinstance(value, Constant))


def _is_of_arrays(statement: AST, types: Mapping[str, Type]) -> bool:
    """Whether a statement is a loop, stores into an array, makes one or gives one to a function."""
    given = {n.id for part in walk(statement) if user_call(part) for n in part.args if isinstance(n, Name)}
    bound = {base_name(t) for s in walk_statements(statement) for t in targets(s)}
    return isinstance(statement, (For, While)) or any(n in types and types[n].is_array for n in given | bound)
