"""Units are differentiated: `analyze`, `differentiate` and `simplify`, for what is wanted of each once."""
from __future__ import annotations

from dataclasses import dataclass, field, replace

from s2sad.analyze.activity import Activity, activity
from s2sad.analyze.dependence import Dependence
from s2sad.analyze.liveness import base_name, targets
from s2sad.analyze.order import order_free
from s2sad.analyze.plan import Plan, Question
from s2sad.analyze.recorded import recorded
from s2sad.analyze.resized import repeated
from s2sad.analyze.structure import structure
from s2sad.analyze.unbounded import Unbounded, unbounded
from s2sad.analyze.uses import Uses, uses
from s2sad.diagnostics import Report
from s2sad.differentiate.adjoint import REVERSE, adjoint
from s2sad.differentiate.calls import Callee, Pattern, call_uses, is_kernel_call, pattern
from s2sad.differentiate.derivative import Made, Wanted
from s2sad.differentiate.owned import owned
from s2sad.differentiate.tangent import tangent
from s2sad.infer.infer import Typing
from s2sad.differentiate.implicit import Residual, solution_of, wrong_implicit
from s2sad.infer.types import FLOAT, Type
from s2sad.naming import Names
from s2sad.normalize.form import verify
from s2sad.normalize.functions import functions
from s2sad.normalize.hidden import hidden_arrays
from s2sad.normalize.scalarize import scalarize
from s2sad.normalize.workspace import is_allocation
from s2sad.simplify import Effect, Effects, simplify
from s2sad.simplify.dead import dead
from s2sad.simplify.quotients import quotients
from s2sad.simplify.wide_sums import is_real, is_single, wide_numbers, wide_sums
from s2sad.tree import AST, Assign, AugAssign, Call, Expr, FunctionDef, Return, const, index, walk
from s2sad.units.array_forms import with_choices
from s2sad.units.normal_forms import NormalForms
from s2sad.units.unit import Unit


@dataclass
class Derived:
    """A derivative made: its function, what a caller must know, and what is to be reported."""
    callee: Callee
    function: FunctionDef
    made: Made
    unit: Unit
    activity: Activity
    types: dict[str, Type]
    wanted: Wanted
    plan: Plan | None = None
    beside: tuple[FunctionDef, ...] = ()

    @property
    def mode(self) -> str:
        return "tangent" if self.plan is None else "adjoint"


@dataclass
class Units(NormalForms):
    """Everything made for one program and one engine."""
    derived: dict[tuple, Derived] = field(default_factory=dict)
    forwards: dict[str, str] = field(default_factory=dict)
    infinite: dict[str, Unbounded] = field(default_factory=dict)

    def again(self) -> Units:
        """The same units with nothing derived: no text depends on what was derived before it."""
        return replace(self, made=dict(self.made), titled=dict(self.titled), titles=self.titles.copy(),
                       effects=Effects(dict(self.effects.table)), derived={}, forwards={})

    def derive(self, mode: str, unit: Unit, wanted: Wanted, flat: bool = False) -> Derived:
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

    def activity(self, unit: Unit, wanted: Wanted) -> Activity:
        return activity(unit.function, unit.typing, set(wanted.wrt), set(wanted.of), self.call_edges)

    def fresh(self, unit: Unit) -> tuple[Typing, Names]:
        """Tables of their own for one derivative, so that its names do not depend on what was made before."""
        typing = self.apart(unit.typing)
        names = Names(unit.names.taken | set(unit.typing.table))
        names.wanted = dict(unit.names.wanted)
        return typing, names

    def _adjoint(self, unit: Unit, wanted: Wanted, title: str) -> Derived:
        found = self.activity(unit, wanted)
        self._refuse(unit, found, "adjoint")
        typing, names = self.fresh(unit)
        table = structure(unit.function, typing)
        deriving = self.for_calls("adjoint")

        bounds = unbounded(unit.function, typing, found, self.unbounded, wanted.unbounded)

        def reads_of(statement: AST) -> Uses:
            return uses(statement, typing, found.active, lambda s, u: call_uses(
                s, typing, found.active, deriving, u, bounds.called_left) if is_kernel_call(s) else None)

        def writes(statement: AST) -> list[AST]:
            if repeated(table, statement):
                return [index(statement.targets[0], const(...))]
            return self.writes(statement)

        question = Question(table, Dependence(table), lambda s: is_active_statement(s, typing, found), reads_of, writes,
                            self.seen_after, quick=self.engine == "numba")
        plan = recorded(question)
        plan.forwards = order_free(question, plan) if self.engine == "numba" else frozenset()
        made = adjoint(table, found, plan, wanted, names, deriving, unit.family, title, bounds)
        return self._finished(unit, wanted, made, found, typing, names, plan)

    def _tangent(self, unit: Unit, wanted: Wanted, title: str, flat: bool) -> Derived:
        found = self.activity(unit, wanted)
        self._refuse(unit, found, "tangent")
        typing, names = self.fresh(unit)
        bounds = unbounded(unit.function, typing, found, self.unbounded, wanted.unbounded)
        made = tangent(structure(unit.function, typing), found, wanted, names, self.for_calls("tangent"), title, bounds,
                       flat)
        return self._finished(unit, wanted, made, found, typing, names, None)

    def unbounded(self, called: Call) -> Unbounded | None:
        """What can be infinite or nan in a kernel that is called, whatever is active there."""
        unit = self.called(called)
        if unit is None:
            return None
        if unit.title not in self.infinite:
            every = Activity(frozenset(unit.typing.table), frozenset(unit.typing.table), ())
            self.infinite[unit.title] = unbounded(unit.function, unit.typing, every, self.unbounded)
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

    def wrong(self, unit: Unit, wanted: Wanted, mode: str) -> str:
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

    def _own(self, mode: str, unit: Unit, wanted: Wanted, title: str) -> Derived:
        """The derivative that calls the user's."""
        made = owned(unit.owner, self.residual(unit), mode, wanted, title, self.forwards.get(unit.title, ""),
                     self.titles.fresh)
        self.effects.table[title] = Effect(made.reads, made.writes, True, made.arrays)
        if made.callee.forward:
            plain, half = self.effects.table[unit.title], made.callee.forward.partition(".")[2]
            self.forwards[unit.title] = half
            self.effects.table[half] = Effect(plain.arrays, plain.writes, plain.pure, plain.arrays)
        return Derived(made.callee, made.made.function, made.made, unit, self.activity(unit, wanted), made.types,
                       wanted, Plan() if mode == "adjoint" else None, made.beside)

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

        def derive(mode: str, wrt: tuple[str, ...], of: tuple[str, ...]) -> Callee:
            return self.derive(mode, inner, Wanted(wrt, of, mode == "tangent"), mode == "tangent").callee
        return Residual(title, taken, inner.summary.results, written, derive)

    def _finished(self, unit: Unit, wanted: Wanted, made: Made, found: Activity, typing: Typing, names: Names,
                  plan: Plan | None) -> Derived:
        function, single = made.function, plan is not None and is_single(typing)
        if single:
            function, made.sums = wide_sums(function, made.shadows.values(), typing, names)
        if self.engine == "numba":
            function = dead(function, self._live_out(made, typing, plan is None), self.effects.writes,
                            self.effects.pure, self.effects.unread)
            alone = functions(function, typing, names, added=True)
            function = with_choices(scalarize(alone, typing, names, final=True), typing)
        arrays = self._live_out(made, typing, plan is None)
        family = {**unit.family, **{s: f"{unit.family.get(p, p)}_{'bar' if plan else 'dot'}"
                                    for p, s in made.shadows.items() if typing.table[s].is_number}}
        self.watch("differentiate", verify(function, "derivative", "differentiate"))
        kept = set(unit.family) | {made.shadows[v] for v in unit.family if v in made.shadows}
        shadows = {s: p for p, s in made.shadows.items()}
        function = simplify(function, typing, family, arrays, self.effects, names, kept, shadows, self.watch,
                            self.engine == "numba")
        function = quotients(function, typing) if self.engine == "numba" else function
        if single and self.engine == "numpy" and is_real(typing):
            function = wide_numbers(function, {*unit.family, *unit.family.values()}, REVERSE)
        self.effects.add(verify(function, "derivative", "simplify"), typing)
        parameters = made.parameters
        shadows = [k for k, (_, role, primal) in enumerate(parameters) if role == "shadow"]
        order = [p for p, role, _ in parameters if role == "primal"]
        effect = self.effects.table[function.name]
        position = {n: k for k, (n, _, _) in enumerate(parameters)}
        callee = Callee(
            f"user.{function.name}", tuple(order.index(parameters[k][2]) for k in shadows),
            tuple(int(o.split()[1]) for o in wanted.of if o.startswith("return ")),
            tuple(order.index(p) for p in wanted.wrt if typing.table[p].is_number),
            tuple(k for k, p in enumerate(order) if position[p] in effect.reads),
            tuple(k for k, p in enumerate(order) if position[p] in effect.writes))
        return Derived(callee, function, made, unit, found, dict(typing.table), wanted, plan)

    def _live_out(self, made: Made, typing: Typing, primals: bool) -> set[str]:
        """The arrays whose content the caller reads: the shadows, of a tangent the primals too."""
        return {n for n, role, _ in made.parameters if typing.table[n].is_array and (primals or role == "shadow")}

    def for_calls(self, mode: str):
        def made(pattern: Pattern) -> Callee:
            unit = self.unit(pattern.kernel, pattern.types)
            return self.derive(mode, unit, self.wanted(pattern, mode), mode == "tangent").callee
        return made

    def wanted(self, pattern: Pattern, mode: str) -> Wanted:
        """What a call asks for."""
        unit = self.unit(pattern.kernel, pattern.types)
        parameters = [p.id for p in unit.function.args.args]
        arguments = tuple(parameters[k] for k in pattern.arguments)
        written = {parameters[k] for k in unit.summary.written}
        of = tuple(p for p in arguments if p in written) + tuple(f"return {k}" for k in pattern.results)
        return Wanted(arguments, of, mode == "tangent", pattern.unbounded and unit.kernel.own is None)


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
