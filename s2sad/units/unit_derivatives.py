"""Units are differentiated: `analyze`, `differentiate` and `simplify`, for what is wanted of each once."""
from __future__ import annotations

from dataclasses import dataclass, field, replace

from s2sad.analyze.activity import Activity, activity
from s2sad.analyze.dependence import Dependence
from s2sad.liveness import base_name, targets
from s2sad.analyze.commuting_iterations import order_free
from s2sad.analyze.recording_plan import RecordingPlan, PlanningInputs
from s2sad.analyze.to_be_recorded import to_be_recorded
from s2sad.analyze.reallocated_arrays import repeated
from s2sad.analyze.structure import structure
from s2sad.analyze.unbounded_values import UnboundedValues, unbounded_values
from s2sad.analyze.uses import OperandUses, uses
from s2sad.diagnostics import Report
from s2sad.differentiate.adjoint import adjoint
from s2sad.differentiate.callee_derivatives import CalleeDerivative, ActivityPattern, call_uses, is_kernel_call, pattern
from s2sad.differentiate.request import Derivative, DerivativeRequest
from s2sad.differentiate.user_derivative import user_derivative
from s2sad.differentiate.tangent import tangent
from s2sad.infer.inference import Typing
from s2sad.differentiate.implicit import Residual, solution_of, wrong_implicit
from s2sad.infer.types import FLOAT, Type
from s2sad.naming import Names
from s2sad.form import verify
from s2sad.normalize.calls.global_arrays import hidden_arrays
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad import simplify
from s2sad.simplify import DerivativeContext, Effect, Effects
from s2sad.passes import run
from s2sad.simplify.wide_accumulators import uses_float32
from s2sad.tree import AST, Assign, AugAssign, Call, Expr, FunctionDef, Return, const, index, walk
from s2sad.units.normal_forms import NormalForms
from s2sad.units.unit import Unit


@dataclass
class UnitDerivative:
    """A derivative made: its function, what a caller must know, and what is to be reported."""
    callee: CalleeDerivative
    function: FunctionDef
    made: Derivative
    unit: Unit
    activity: Activity
    types: dict[str, Type]
    wanted: DerivativeRequest
    plan: RecordingPlan | None = None
    beside: tuple[FunctionDef, ...] = ()

    @property
    def mode(self) -> str:
        return "tangent" if self.plan is None else "adjoint"


@dataclass
class Units(NormalForms):
    """Everything made for one program and one engine."""
    derived: dict[tuple, UnitDerivative] = field(default_factory=dict)
    forwards: dict[str, str] = field(default_factory=dict)
    infinite: dict[str, UnboundedValues] = field(default_factory=dict)

    def again(self) -> Units:
        """The same units with nothing derived: no text depends on what was derived before it."""
        return replace(self, made=dict(self.made), titled=dict(self.titled), titles=self.titles.copy(),
                       effects=Effects(dict(self.effects.table)), derived={}, forwards={})

    def derive(self, mode: str, unit: Unit, wanted: DerivativeRequest, flat: bool = False) -> UnitDerivative:
        key = (mode, unit.title, wanted, flat)
        if key not in self.derived:
            others = sum(k[0] == mode and k[1] == unit.title for k in self.derived)
            title = self.titles.fresh(f"{unit.title}_{mode}" + (f"_{others + 1}" if others else ""))
            if unit.kernel.own is not None:
                made = self._own(mode, unit, wanted, title)
            elif mode == "adjoint":
                made = self._adjoint(unit, wanted, title)
            else:
                made = self._tangent(unit, wanted, title, flat)
            self.derived[key] = made
        return self.derived[key]

    def activity(self, unit: Unit, wanted: DerivativeRequest) -> Activity:
        return activity(unit.function, unit.typing, set(wanted.wrt), set(wanted.of), self.call_edges)

    def fresh(self, unit: Unit) -> tuple[Typing, Names]:
        """Tables of their own for one derivative, so that its names do not depend on what was made before."""
        typing = unit.typing.copy()
        names = Names(unit.names.taken | set(unit.typing.table))
        names.wanted = dict(unit.names.wanted)
        return typing, names

    def _adjoint(self, unit: Unit, wanted: DerivativeRequest, title: str) -> UnitDerivative:
        found = self.activity(unit, wanted)
        self._refuse(unit, found, "adjoint")
        typing, names = self.fresh(unit)
        table = structure(unit.function, typing)
        deriving = self.for_calls("adjoint")

        bounds = unbounded_values(unit.function, typing, found, self.unbounded, wanted.unbounded)

        def reads_of(statement: AST) -> OperandUses:
            return uses(statement, typing, found.active, lambda s, u: call_uses(
                s, typing, found.active, deriving, u, bounds.called_left) if is_kernel_call(s) else None)

        def writes(statement: AST) -> list[AST]:
            if repeated(table, statement):
                return [index(statement.targets[0], const(...))]
            return self.writes(statement)

        question = PlanningInputs(table, Dependence(table), lambda s: is_active_statement(s, typing, found), reads_of,
                                  writes, self.seen_after, quick=self.engine == "numba")
        plan = to_be_recorded(question)
        plan.forwards = order_free(question, plan) if self.engine == "numba" else frozenset()
        made = adjoint(table, found, plan, wanted, names, deriving, unit.family, title, bounds)
        return self._finished(unit, wanted, made, found, typing, names, plan)

    def _tangent(self, unit: Unit, wanted: DerivativeRequest, title: str, flat: bool) -> UnitDerivative:
        found = self.activity(unit, wanted)
        self._refuse(unit, found, "tangent")
        typing, names = self.fresh(unit)
        bounds = unbounded_values(unit.function, typing, found, self.unbounded, wanted.unbounded)
        made = tangent(structure(unit.function, typing), found, wanted, names, self.for_calls("tangent"), title, bounds,
                       flat)
        return self._finished(unit, wanted, made, found, typing, names, None)

    def unbounded(self, called: Call) -> UnboundedValues | None:
        """What can be infinite or nan in a kernel that is called, whatever is active there."""
        unit = self.called(called)
        if unit is None:
            return None
        if unit.title not in self.infinite:
            every = Activity(frozenset(unit.typing.table), frozenset(unit.typing.table), ())
            self.infinite[unit.title] = unbounded_values(unit.function, unit.typing, every, self.unbounded)
        return self.infinite[unit.title]

    def _refuse(self, unit: Unit, found: Activity, mode: str) -> None:
        """Raises where a call asks for what a derivative of the user's own does not give."""
        report = Report(unit.kernel.source)
        for statement in walk(unit.function.body):
            if not isinstance(statement, (Assign, AugAssign, Expr)) or not is_kernel_call(statement):
                continue
            asked = pattern(statement, unit.typing, found.active)
            called = self.called(statement.value)
            if called is None or called.kernel.own is None:
                continue
            if not (asked.arguments or asked.results or self.solves_nothing(called)):
                continue
            wrong = self.wrong(called, self.wanted(asked, mode), mode)
            if wrong:
                report.error("S301", f"'{called.kernel.own.title}' {wrong}", statement,
                             help="give it with s2sad.rule, whose docstring says what it takes and returns")
        report.finish()

    def solves_nothing(self, unit: Unit) -> bool:
        """Whether nothing that an implicit function writes or returns is what its residual is for: no derivative would
        ever be asked of it."""
        residual = self.residual(unit)
        return residual is not None and not solution_of(residual.parameters, unit.owner.written) and not any(
            t.is_float for t in unit.summary.results)

    def wrong(self, unit: Unit, wanted: DerivativeRequest, mode: str) -> str:
        """Why a call cannot have the derivative of the user's own, in words; empty if it can."""
        residual = self.residual(unit)
        if unit.pairs:
            return "is given one array twice, and writes it; no derivative of its own is for that"
        if residual is not None:
            return wrong_implicit(unit.owner, residual, wanted)
        entry = next(u for u in self.made.values() if u.kernel.name == self.program.entry)
        parameters = [p.id for p in entry.function.args.args]
        written = {parameters[k] for k in entry.summary.written}
        outside = [a for p, a in hidden_arrays(self.program).items() if p in unit.owner.types and p in written]
        if outside:
            return f"reads '{outside[0]}', an array of its module that is written; so may its own derivative, too late"
        return unit.owner.wrong(mode, wanted)

    def _own(self, mode: str, unit: Unit, wanted: DerivativeRequest, title: str) -> UnitDerivative:
        """The derivative that calls the user's."""
        made = user_derivative(unit.owner, self.residual(unit), mode, wanted, title, self.forwards.get(unit.title, ""),
                     self.titles.fresh)
        self.effects.table[title] = Effect(made.reads, made.writes, True, made.arrays)
        if made.callee.forward:
            plain, half = self.effects.table[unit.title], made.callee.forward.partition(".")[2]
            self.forwards[unit.title] = half
            self.effects.table[half] = Effect(plain.arrays, plain.writes, plain.pure, plain.arrays)
        return UnitDerivative(made.callee, made.made.function, made.made, unit, self.activity(unit, wanted), made.types,
                              wanted, RecordingPlan() if mode == "adjoint" else None, made.beside)

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

    def _finished(self, unit: Unit, wanted: DerivativeRequest, made: Derivative, found: Activity, typing: Typing,
                  names: Names, plan: RecordingPlan | None) -> UnitDerivative:
        context = DerivativeContext(
            program=self.program, kernel=unit.kernel, names=names, engine=self.engine, watch=self.watch,
            types=typing.table, effects=self.effects, live_out=self._live_out(made, typing, plan is None),
            adjoint=plan is not None, kernel_names=unit.family, single=plan is not None and uses_float32(typing),
            shadows={s: p for p, s in made.shadows.items()},
            kept=set(unit.family) | {made.shadows[v] for v in unit.family if v in made.shadows})
        context.typing = typing
        self.watch("differentiate", verify(made.function, "derivative", "differentiate"))
        function = run(simplify.LOWERED, made.function, context)
        context.family = {**unit.family, **{s: f"{unit.family.get(p, p)}_{'bar' if plan else 'dot'}"
                                            for p, s in made.shadows.items() if typing.table[s].is_number}}
        function = run(simplify.PASSES, function, context)
        made.sums = set(context.sums)
        self.effects.add(verify(function, "derivative", "simplify"), typing)
        parameters = made.parameters
        shadows = [k for k, (_, role, primal) in enumerate(parameters) if role == "shadow"]
        order = [p for p, role, _ in parameters if role == "primal"]
        effect = self.effects.table[function.name]
        position = {n: k for k, (n, _, _) in enumerate(parameters)}
        callee = CalleeDerivative(
            f"user.{function.name}", tuple(order.index(parameters[k][2]) for k in shadows),
            tuple(int(o.split()[1]) for o in wanted.of if o.startswith("return ")),
            tuple(order.index(p) for p in wanted.wrt if typing.table[p].is_number),
            tuple(k for k, p in enumerate(order) if position[p] in effect.reads),
            tuple(k for k, p in enumerate(order) if position[p] in effect.writes))
        return UnitDerivative(callee, function, made, unit, found, dict(typing.table), wanted, plan)

    def _live_out(self, made: Derivative, typing: Typing, primals: bool) -> set[str]:
        """The arrays whose content the caller reads: the shadows, of a tangent the primals too."""
        return {n for n, role, _ in made.parameters if typing.table[n].is_array and (primals or role == "shadow")}

    def for_calls(self, mode: str):
        def made(pattern: ActivityPattern) -> CalleeDerivative:
            unit = self.unit(pattern.kernel, pattern.types)
            return self.derive(mode, unit, self.wanted(pattern, mode), mode == "tangent").callee
        return made

    def wanted(self, pattern: ActivityPattern, mode: str) -> DerivativeRequest:
        """What a call asks for."""
        unit = self.unit(pattern.kernel, pattern.types)
        parameters = [p.id for p in unit.function.args.args]
        arguments = tuple(parameters[k] for k in pattern.arguments)
        written = {parameters[k] for k in unit.summary.written}
        of = tuple(p for p in arguments if p in written) + tuple(f"return {k}" for k in pattern.results)
        return DerivativeRequest(arguments, of, mode == "tangent", pattern.unbounded if unit.kernel.own is None
                                 else frozenset())


def is_active_statement(statement: AST, typing: Typing, found: Activity) -> bool:
    """Whether a statement has an adjoint."""
    if isinstance(statement, Return):
        return True
    if is_kernel_call(statement):
        bound = [base_name(t) for t in targets(statement)]
        return any(b in found.active for b in bound) or any(
            typing.of(a).is_array and base_name(a) in found.active for a in statement.value.args)
    if not isinstance(statement, (Assign, AugAssign)) or is_allocation(statement):
        return False
    target = targets(statement)[0]
    return base_name(target) in found.active and typing.of(target).is_inexact
