"""Units: the kernels of a program in normal form, one per set of argument types, and their derivatives, each made once.

A unit's summary says what a call of it writes, what depends on what, and whether it may be left out.
"""
from __future__ import annotations

from dataclasses import dataclass, field, replace

from s2sad.analyze.activity import Activity, activity, reach
from s2sad.analyze.dependence import Dependence
from s2sad.analyze.liveness import Liveness, base_name, targets
from s2sad.analyze.order import order_free
from s2sad.analyze.plan import Plan, Question
from s2sad.analyze.recorded import recorded
from s2sad.analyze.resized import repeated
from s2sad.analyze.structure import Structure, structure
from s2sad.analyze.uses import Uses, owns_result, uses
from s2sad.diagnostics import Report
from s2sad.differentiate.adjoint import Made, Wanted, adjoint
from s2sad.differentiate.arithmetic import scalar_choices
from s2sad.differentiate.calls import Callee, Pattern, call_uses, is_kernel_call, pattern
from s2sad.differentiate.own import Owner, own_edges
from s2sad.differentiate.owned import owned
from s2sad.differentiate.tangent import tangent
from s2sad.infer.infer import Typing, infer
from s2sad.differentiate.implicit import Residual, solution_of, wrong_implicit
from s2sad.infer.types import FLOAT, Type
from s2sad.naming import Names
from s2sad.normalize import structured
from s2sad.normalize.atoms import atoms
from s2sad.normalize.choices import choices
from s2sad.normalize.contracted import batched, contracted
from s2sad.normalize.factored import factored
from s2sad.normalize.form import verify
from s2sad.normalize.functions import functions
from s2sad.normalize.hidden import hidden_arrays
from s2sad.normalize.inlined import Helpers, inlined, returned
from s2sad.normalize.parts import parts
from s2sad.normalize.pieces import pieces
from s2sad.normalize.rename import rename
from s2sad.normalize.memory import Memory
from s2sad.normalize.rows import rows
from s2sad.normalize.ruled import ruled
from s2sad.normalize.scalarize import scalarize, scatter
from s2sad.normalize.sharing import shared, specialised
from s2sad.normalize.solvers import solvers
from s2sad.normalize.sought import sought
from s2sad.normalize.spelled import spelled
from s2sad.normalize.viewing import viewing
from s2sad.normalize.views import views
from s2sad.normalize.workspace import is_allocation, workspace
from s2sad.program import Kernel, Program
from s2sad.simplify import Effect, Effects, Watch, simplify, unwatched
from s2sad.simplify.dead import dead
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Call, Expr, FunctionDef, Name, Raise, Return, Subscript, call_name, const, copy,
    index, name, stored_names, walk,
)


@dataclass(frozen=True)
class Summary:
    """What a call of a unit does: positions written, pairs (argument, argument or "return k") of dependence."""
    written: tuple[int, ...]
    results: tuple[Type, ...]
    returned: dict[int, str]
    edges: tuple[tuple[int, int | str], ...]
    pure: bool


@dataclass
class Unit:
    """A kernel for given types, in normal form."""
    kernel: Kernel
    title: str
    types: tuple[Type, ...]
    function: FunctionDef
    typing: Typing
    family: dict[str, str]
    names: Names
    lowered: FunctionDef
    structure: Structure
    summary: Summary
    guarded: bool = False
    pairs: tuple[tuple[int, int], ...] = ()
    once: bool = False

    @property
    def owner(self) -> Owner:
        """What stands of it where its derivative is the user's own."""
        assert self.kernel.own is not None
        parameters = [p.id for p in self.function.args.args]
        return Owner(self.title, self.kernel.own, dict(zip(parameters, self.types)), self.summary.results,
                     frozenset(parameters[k] for k in self.summary.written))

    def first_use(self, parameter: str) -> bool:
        """Whether the kernel may read what an array held at its start."""
        live = Liveness(self.function, set(), lambda call: [], lambda call: False, strong=False)
        return parameter in live.start


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
class Units:
    """Everything made for one program and one engine."""
    program: Program
    engine: str
    made: dict[tuple[str, tuple[Type, ...], tuple[tuple[int, int], ...]], Unit] = field(default_factory=dict)
    titled: dict[str, Unit] = field(default_factory=dict)
    derived: dict[tuple, Derived] = field(default_factory=dict)
    effects: Effects = field(default_factory=Effects)
    titles: Names = field(default_factory=Names)
    watch: Watch = unwatched
    forwards: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.titles.taken |= set(self.program.kernels)
        self.helpers = Helpers(self.program, plain_form)

    # -- normal form -------------------------------------------------------------------------------------------------

    def unit(self, kernel: str, types: tuple[Type, ...], pairs: tuple[tuple[int, int], ...] = ()) -> Unit:
        """The unit of a kernel, or of a unit's title, for these types; `pairs` of its arguments are one array."""
        if kernel in self.titled and not pairs:
            if self.titled[kernel].types == types:
                return self.titled[kernel]
            pairs = self.titled[kernel].pairs
        kernel = self.titled[kernel].kernel.name if kernel in self.titled else kernel
        key = (kernel, types, pairs)
        if key not in self.made:
            others = sum(k == kernel for k, _, _ in self.made)
            title = self.titles.fresh(f"{kernel}_{others + 1}") if others else kernel
            source = self.program.kernels[kernel]
            unit = self._prepared(specialised(source, pairs) if pairs else source, types, title)
            unit.pairs = pairs
            self.made[key] = self.titled[title] = unit
            self.effects.table[title] = Effect(
                frozenset(k for k, p in enumerate(unit.function.args.args) if unit.first_use(p.id)),
                frozenset(unit.summary.written), unit.summary.pure,
                frozenset(k for k, t in enumerate(types) if t.is_array))
        return self.made[key]

    def _prepared(self, kernel: Kernel, types: tuple[Type, ...], title: str) -> Unit:
        """The passes of `normalize` and `infer`, in order."""
        if kernel.own is not None and "primal" in kernel.own.functions:
            return self._unread(kernel, types, title)
        names = Names()
        values = {**self.program.constants, **self.program.arrays}
        tree = verify(plain_form(kernel, names, self.program), "structured", "spelled")
        given = dict(zip((p.id for p in tree.args.args), types))
        tree, source = inlined(tree, given, names, kernel.source, self.helpers)
        kernel, report = replace(kernel, source=source), Report(source)
        self.watch("structured", tree)
        table = infer(tree, given, self.call_types, report, values)
        report.finish()
        typing = Typing({**table, **given}, self.call_types, report, values)
        typing.final = True
        tree = rows(tree, typing, Memory(tree, self.program), report)
        report.finish()
        tree = sought(batched(choices(tree, typing, names), typing), typing, self.engine == "numba")
        ruled(tree, typing, report)
        report.finish()
        tree = functions(tree, typing, names)

        def written(called: Call) -> tuple[int, ...]:
            return self.of_call(called, typing).summary.written
        viewing(tree, typing, lambda called: [base_name(called.args[k]) for k in written(called)], report)
        plain = tree = pieces(tree, typing, names, report)
        report.finish()
        tree = views(tree, typing.table, typing, names, written, report, self.engine == "numba")
        report.finish()
        guarded = count(tree, Assert) > count(plain, Assert)
        self.watch("views", tree)
        tree = workspace(tree)
        tree = verify(self.with_titles(tree, typing, report), "views", "workspace")
        report.finish()
        self.watch("workspace", tree)
        lowered = tree
        if self.engine == "numba":
            lowered = with_choices(scalarize(tree, self.apart(typing), Names(names.taken), final=True))
            tree = verify(scalarize(factored(tree, typing, names), typing, names), "views", "scalarize")
        else:
            tree = lowered = verify(scatter(tree, typing, names), "views", "scatter")
        self.watch("scalarize", tree)
        renamed = rename(tree, typing.table, names, self.call_writes)
        self.watch("rename", verify(renamed.function, "rename", "rename"))
        table = infer(renamed.function, given, self.call_types, report, values)
        report.finish()
        typing = Typing({**table, **given}, self.call_types, report, values)
        tree = self.with_titles(renamed.function, typing, report)
        tree = verify(atoms(tree, typing, names, written_arrays(tree, self)), "atoms", "atoms")
        self.watch("atoms", tree)
        typing.runs_once = self.runs_once
        once = kernel.own is not None or any(self.runs_once(n) for n in walk(tree.body) if isinstance(n, Call))
        return Unit(kernel, title, types, tree, typing, dict(renamed.family), names, lowered, structure(tree, typing),
                    self._summary(tree, typing, kernel), guarded, once=once)

    def _unread(self, kernel: Kernel, types: tuple[Type, ...], title: str) -> Unit:
        """The unit of a function that is called as it is, of which is known what the user says."""
        own, tree = kernel.own, kernel.tree
        assert own is not None
        parameters = [p.id for p in tree.args.args]
        given = dict(zip(parameters, types))
        results = (FLOAT,) * own.returns
        table = {**given, **dict.fromkeys(stored_names(tree.body), FLOAT)}
        typing = Typing(table, self.call_types, Report(kernel.source), {})
        edges = own_edges(given, results, set(own.writes), [], self.solved_by(kernel))
        written = tuple(k for k, p in enumerate(parameters) if p in own.writes)
        summary = Summary(written, results, {}, tuple(edges), True)
        return Unit(kernel, title, types, tree, typing, {}, Names(table), tree, structure(tree, typing), summary,
                    once=True)

    def apart(self, typing: Typing) -> Typing:
        """A table of types of its own."""
        made = Typing(dict(typing.table), self.call_types, typing.report, typing.constants)
        made.ones = dict(typing.ones)
        made.runs_once = typing.runs_once
        return made

    def _summary(self, tree: FunctionDef, typing: Typing, kernel: Kernel) -> Summary:
        parameters = [p.id for p in tree.args.args]
        written = written_arrays(tree, self)
        arrows: dict[str, list[str]] = {}
        for a, b in activity(tree, typing, set(), set(), self.call_edges).edges:
            arrows.setdefault(a, []).append(b)
        edges: list[tuple[int, int | str]] = []
        for position, parameter in enumerate(parameters):
            found = reach(arrows, {parameter})
            edges += [(position, k) for k, p in enumerate(parameters) if p in found and p in written]
            edges += [(position, f) for f in sorted(found) if f.startswith("return ")]
        parts = returned(tree)
        guards = any(isinstance(n, (Assert, Raise)) or call_name(n) == "builtins.print" for n in walk(tree.body))
        calls = [n for n in walk(tree.body) if isinstance(n, Call) and (call_name(n) or "").startswith("user.")]
        results = tuple(map(typing.of, parts))
        if kernel.own is not None:
            edges = own_edges({p: typing.table[p] for p in parameters}, results, written, edges,
                              self.solved_by(kernel))
        return Summary(tuple(k for k, p in enumerate(parameters) if p in written), tuple(map(typing.of, parts)),
                       {k: p.id for k, p in enumerate(parts) if isinstance(p, Name) and p.id in parameters
                        and typing.of(p).is_array},
                       tuple(edges), not guards and all(self.of_call(c, typing).summary.pure for c in calls))

    def solved_by(self, kernel: Kernel) -> tuple[str, ...] | None:
        """The parameters of the residual of an implicit function; None for any other function."""
        return self.program.kernels[kernel.residual].parameters if kernel.residual else None

    # -- calls -------------------------------------------------------------------------------------------------------

    def runs_once(self, node: Call) -> bool:
        """Whether a kernel's call is not run again by a reverse sweep: its derivative is the user's own."""
        unit = self.called(node)
        return unit is not None and unit.once

    def of_call(self, called: Call, typing: Typing) -> Unit:
        return self.unit((call_name(called) or "").partition(".")[2], tuple(map(typing.argument, called.args)))

    def call_types(self, kernel: str, types: tuple[Type, ...]) -> tuple[Type, ...]:
        return self.unit(kernel, types).summary.results

    def with_titles(self, tree: FunctionDef, typing: Typing, report: Report) -> FunctionDef:
        """The tree with every kernel's call naming the unit for its arguments: their types, and which are one array."""
        new = copy(tree)
        for node in walk(new.body):
            if not isinstance(node, Call) or not (call_name(node) or "").startswith("user."):
                continue
            unit = self.of_call(node, typing)
            pairs = shared(node, unit.summary.written, typing, report)
            if pairs:
                node.args = [a for k, a in enumerate(node.args) if all(k != gone for gone, _ in pairs)]
                unit = self.unit(unit.kernel.name, tuple(map(typing.argument, node.args)), pairs)
            node.func = name(f"user.{unit.title}")
        return new

    def called(self, node: Call) -> Unit | None:
        room, _, title = (call_name(node) or "").partition(".")
        return self.titled.get(title) if room == "user" else None

    def call_writes(self, node: Call) -> list[str]:
        """The arrays that a call may write."""
        unit = self.called(node)
        return [] if unit is None else [base_name(node.args[p]) for p in unit.summary.written]

    def call_edges(self, node: Call) -> list[tuple[int, int | str]]:
        unit = self.called(node)
        return [] if unit is None else list(unit.summary.edges)

    def writes(self, statement: AST) -> list[AST]:
        """The array places that a statement itself overwrites."""
        found: list[AST] = [t for t in targets(statement) if isinstance(t, Subscript)]
        if is_kernel_call(statement) and (unit := self.called(statement.value)) is not None:
            found += [statement.value.args[p] for p in unit.summary.written]
        return found

    def seen_after(self, statement: AST) -> bool:
        """Whether a statement's adjoint runs in the state that it leaves: it solves for what it writes."""
        unit = self.called(statement.value) if is_kernel_call(statement) else None
        return owns_result(statement) if unit is None else bool(unit.kernel.residual)

    # -- derivatives -------------------------------------------------------------------------------------------------

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

        def reads_of(statement: AST) -> Uses:
            return uses(statement, typing, found.active,
                        lambda s, u: call_uses(s, typing, found.active, deriving, u) if is_kernel_call(s) else None)

        def writes(statement: AST) -> list[AST]:
            if repeated(table, statement):
                return [index(statement.targets[0], const(...))]
            return self.writes(statement)

        question = Question(table, Dependence(table), lambda s: is_active_statement(s, typing, found), reads_of, writes,
                            self.seen_after, quick=self.engine == "numba")
        plan = recorded(question)
        plan.forwards = order_free(question) if self.engine == "numba" else frozenset()
        made = adjoint(table, found, plan, wanted, names, deriving, unit.family, title)
        return self._finished(unit, wanted, made, found, typing, names, plan)

    def _tangent(self, unit: Unit, wanted: Wanted, title: str, flat: bool) -> Derived:
        found = self.activity(unit, wanted)
        self._refuse(unit, found, "tangent")
        typing, names = self.fresh(unit)
        made = tangent(structure(unit.function, typing), found, wanted, names, self.for_calls("tangent"), title, flat)
        return self._finished(unit, wanted, made, found, typing, names, None)

    def _refuse(self, unit: Unit, found: Activity, mode: str) -> None:
        """Raises where a call asks for what a derivative of the user's own does not give."""
        report = Report(unit.kernel.source)
        for statement in walk(unit.function.body):
            if not isinstance(statement, (Assign, AugAssign, Expr)) or not is_kernel_call(statement):
                continue
            asked = pattern(statement, unit.typing, found.active)
            called = self.called(statement.value)
            if called is None or called.kernel.own is None or not asked.arguments and not asked.results:
                continue
            wrong = self.wrong(called, self.wanted(asked, mode), mode)
            if wrong:
                report.error("S301", f"'{called.kernel.own.title}' {wrong}", statement,
                             help="give it with s2sad.rule, whose docstring says what it takes and returns")
        report.finish()

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
        function = made.function
        if self.engine == "numba":
            function = dead(function, self._live_out(made, typing, plan is None), self.effects.writes,
                            self.effects.pure, self.effects.unread)
            function = with_choices(scalarize(functions(function, typing, names), typing, names, final=True))
        arrays = self._live_out(made, typing, plan is None)
        family = {**unit.family, **{s: f"{unit.family.get(p, p)}_{'bar' if plan else 'dot'}"
                                    for p, s in made.shadows.items() if typing.table[s].is_number}}
        self.watch("differentiate", verify(function, "derivative", "differentiate"))
        kept = set(unit.family) | {made.shadows[v] for v in unit.family if v in made.shadows}
        shadows = {s: p for p, s in made.shadows.items()}
        function = simplify(function, typing, family, arrays, self.effects, names, kept, shadows, self.watch,
                            self.engine == "numba")
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
        return Wanted(arguments, of, mode == "tangent")


def plain_form(kernel: Kernel, names: Names, program: Program) -> FunctionDef:
    """A kernel in structured form, before types are known."""
    report = Report(kernel.source)
    tree = solvers(structured(kernel, names, program), report)
    report.finish()
    return spelled(contracted(parts(tree, names)))


def with_choices(function: FunctionDef) -> FunctionDef:
    """A function of numbers and elements with every `np.where` as a choice."""
    new = copy(function)
    new.body = [scalar_choices(s) for s in new.body]
    return new


def count(function: FunctionDef, kind: type) -> int:
    """How many statements of a kind a function has."""
    return sum(isinstance(n, kind) for n in walk(function.body))


def written_arrays(tree: FunctionDef, units: Units) -> set[str]:
    """The arrays whose elements a function may write."""
    found: set[str] = set()
    for statement in walk(tree.body):
        if isinstance(statement, (Assign, AugAssign)):
            found |= {base_name(t) for t in targets(statement) if isinstance(t, Subscript)}
        if isinstance(statement, (Assign, AugAssign, Expr)) and is_kernel_call(statement):
            found |= set(units.call_writes(statement.value))
    return found


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
    return base_name(target) in found.active and typing.of(target).is_float
