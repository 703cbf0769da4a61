"""normal_forms: kernels become units by the passes in KERNELS, once for each set of argument types."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from s2sad import normalize, optimize
from s2sad.analyze.activity import activity_of, reach
from s2sad.analyze.program_structure import structure_of
from s2sad.diagnostics import Report
from s2sad.differentiate.user_functions import user_edges
from s2sad.infer.inference import Typing
from s2sad.infer.types import FLOAT, Type, of_value
from s2sad.naming import Names
from s2sad.normalize import canonical_form
from s2sad.normalize.calls.alias_specialization import specialized
from s2sad.normalize.calls.inline import Helpers, returned
from s2sad.normalize.calls.outlining import OutlinedLoop, outlining
from s2sad.normalize.context import NormalContext
from s2sad.normalize.dtypes.complex_support import refuse_own_derivative
from s2sad.normalize.dtypes.float32_promotion import makes_singles
from s2sad.normalize.dtypes.weak_results import KnownResults
from s2sad.passes import Pass, Passes, Watch, run, unwatched
from s2sad.program import Kernel, Program, Snapshots, for_types
from s2sad.simplify import Effect, Effects
from s2sad.simplify.remove_marks import remove_marks
from s2sad.tree import (
    AST, Assert, Call, FunctionDef, Name, Raise, call_name, is_known, stored_names, user_call, walk, with_body,
)
from s2sad.units.call_summaries import Calls, stored_arrays
from s2sad.units.primal_form import primal_form, same_primal
from s2sad.units.unit import UnitSummary, Unit


def keeps_snapshots(context: NormalContext) -> bool:
    return bool(context.callees.checkpoints)


KERNELS: Passes = (
    *normalize.STRUCTURE,
    *normalize.CALLS,
    *normalize.TYPES,
    *normalize.ARRAYS,
    Pass(primal_form, when=normalize.in_loops),
    *normalize.LOOPS,
    Pass(same_primal, when=normalize.in_arrays),
    *optimize.KERNELS,
    Pass(outlining, when=keeps_snapshots, form="views"),
    *normalize.NUMBERS,
)
OUTLINED: Passes = (
    Pass(primal_form, when=normalize.in_loops),
    Pass(same_primal, when=normalize.in_arrays),
)
LOOPS_OF_STEPS: Passes = (
    *OUTLINED,
    *normalize.NUMBERS,
)
STEPS: Passes = (
    *OUTLINED,
    Pass(outlining, form="views"),
    *normalize.NUMBERS,
)


@dataclass
class NormalForms(Calls):
    """The units of one program for one engine, each made once."""
    program: Program
    engine: str
    made: dict[tuple[str, tuple[Type, ...], tuple[tuple[int, int], ...]], Unit] = field(default_factory=dict)
    titled: dict[str, Unit] = field(default_factory=dict)
    effects: Effects = field(default_factory=Effects)
    titles: Names = field(default_factory=Names)
    watch: Watch = unwatched
    checkpoints: Mapping[tuple[str, int, int], Snapshots] = field(default_factory=dict)
    outlined_at: set[tuple[str, int, int]] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.program = replace(self.program, kernels=dict(self.program.kernels))    # more are made on the way
        self.titles.taken |= set(self.program.kernels)
        self.helpers, self.known = Helpers(self.program, canonical_form), KnownResults()
        self.singles = any(makes_singles(k.tree) for k in self.program.kernels.values()) or any(
            of_value(a).dtype == "float32" for a in self.program.arrays.values())

    def unit(self, kernel: str, types: tuple[Type, ...], pairs: tuple[tuple[int, int], ...] = ()) -> Unit:
        """The unit of a kernel, or of a unit's title, for these types; `pairs` of its arguments are one array."""
        if kernel in self.titled and not pairs:
            if self.titled[kernel].types == types or self.titled[kernel].outlined:
                return self.titled[kernel]
            pairs = self.titled[kernel].pairs
        kernel = self.titled[kernel].kernel.name if kernel in self.titled else kernel
        kernel = for_types(self.program.kernels[kernel], types)
        key = (kernel, types, pairs)
        if key not in self.made:
            others = sum(k == kernel for k, _, _ in self.made)
            title = self.titles.fresh(f"{kernel}_{others + 1}") if others else kernel
            source = self.program.kernels[kernel]
            unit = self._normalized(specialized(source, pairs) if pairs else source, types, title)
            unit.pairs = pairs
            self._enter(key, unit)
        return self.made[key]

    def _enter(self, key: tuple[str, tuple[Type, ...], tuple[tuple[int, int], ...]], unit: Unit) -> None:
        """A unit becomes one that can be called."""
        self.made[key] = self.titled[unit.title] = unit
        first = unit.read_first()
        self.effects.table[unit.title] = Effect(
            frozenset(k for k, p in enumerate(unit.function.args.args) if p.id in first),
            frozenset(unit.summary.written), unit.summary.pure,
            frozenset(k for k, t in enumerate(unit.types) if t.is_array))

    def outlined(self, kernel: Kernel, context: NormalContext, loop: OutlinedLoop | None, marks: list[AST]) -> str:
        """The title of the unit of a part of a kernel that is on its way to normal form: of a loop, or of the step of
        one, with marks of what holds in it."""
        title = self.titles.fresh(kernel.name)
        kernel = replace(kernel, name=title)
        types = tuple(context.typing.argument(p) for p in kernel.tree.args.args)
        there = {n.id: n for n in walk(kernel.tree) if isinstance(n, Name)}
        inner = replace(context, kernel=kernel, names=Names(there), given=dict(zip(kernel.parameters, types)))
        table = {n: context.typing.argument(node) for n, node in there.items() if n in context.typing.table}
        inner.report = context.report
        inner.typing = inner.typed(table, context.report, context.typing.final)     # names of others may be made anew
        tree = with_body(kernel.tree, [*marks, *kernel.tree.body])
        tree = run(STEPS if loop is None else LOOPS_OF_STEPS, tree, inner)
        inner.lowered = remove_marks(inner.lowered, inner)
        unit = self._finished(kernel, types, title, tree, inner)
        unit.outlined, unit.loop = True, loop
        unit.runs_once = unit.runs_once or loop is not None
        self._enter((title, types, ()), unit)
        return title

    def _normalized(self, kernel: Kernel, types: tuple[Type, ...], title: str) -> Unit:
        """The kernel after all passes, with their tables."""
        if kernel.own is not None and "primal" in kernel.own.functions:
            return self._opaque(kernel, types, title)
        context = NormalContext(
            program=self.program, kernel=kernel, names=Names(n.id for n in walk(kernel.tree) if isinstance(n, Name)),
            engine=self.engine, watch=self.watch, given=dict(zip((p.id for p in kernel.tree.args.args), types)),
            callees=self, helpers=self.helpers, known=self.known, singles=self.singles)
        tree = run(KERNELS, kernel.tree, context)
        return self._finished(context.kernel, types, title, tree, context)

    def _finished(self, kernel: Kernel, types: tuple[Type, ...], title: str, tree: FunctionDef, context: NormalContext
                  ) -> Unit:
        """The unit of a kernel in normal form."""
        lowered = context.lowered
        typing = context.typing.copy(runs_once=self.runs_once)      # without what it remembers of trees that are gone
        called = [n for n in walk(tree.body) if isinstance(n, Call)]
        own = kernel.own is not None
        return Unit(kernel, title, types, tree, typing, dict(context.family), context.names, lowered,
                    structure_of(tree, typing), self._summary(tree, typing, kernel), context.guarded,
                    runs_once=own or any(map(self.runs_once, called)),
                    has_state=own or any(map(self.has_state, called)),
                    numbers=context.numbers, lowered_types=_types_of_single_bindings(context.lowered_types, lowered),
                    contiguous=tuple(k for k, p in enumerate(tree.args.args) if p.id in context.contiguous))

    def _opaque(self, kernel: Kernel, types: tuple[Type, ...], title: str) -> Unit:
        """The unit of a function that is not read: its summary is the user's declaration."""
        own, tree = kernel.own, kernel.tree
        assert own is not None
        refuse_own_derivative(kernel, types, report := Report(kernel.source))
        report.finish()
        parameters = [p.id for p in tree.args.args]
        types_of = dict(zip(parameters, types))
        results = (FLOAT,) * own.returns
        table = {**types_of, **dict.fromkeys(stored_names(tree.body), FLOAT)}
        typing = Typing(table, self.call_types, Report(kernel.source), {})
        edges = user_edges(types_of, results, set(own.writes), [], self.residual_parameters(kernel))
        written = tuple(k for k, p in enumerate(parameters) if p in own.writes)
        summary = UnitSummary(written, results, {}, tuple(edges), True)
        return Unit(kernel, title, types, tree, typing, {}, Names(table), tree, structure_of(tree, typing), summary,
                    runs_once=not own.repeatable, has_state=not own.repeatable)

    def _summary(self, tree: FunctionDef, typing: Typing, kernel: Kernel) -> UnitSummary:
        parameters = [p.id for p in tree.args.args]
        written = stored_arrays(tree, self)
        arrows: dict[str, list[str]] = {}
        for a, b in activity_of(tree, typing, set(), set(), self.call_edges).edges:
            arrows.setdefault(a, []).append(b)
        edges: list[tuple[int, int | str]] = []
        for position, parameter in enumerate(parameters):
            found = reach(arrows, {parameter})
            edges += [(position, k) for k, p in enumerate(parameters) if p in found and p in written]
            edges += [(position, f) for f in sorted(found) if f.startswith("return ")]
        parts = returned(tree)
        guards = any(isinstance(n, (Assert, Raise)) and not is_known(n) or call_name(n) == "builtins.print"
                     for n in walk(tree.body))
        calls = [n for n in walk(tree.body) if user_call(n)]
        results = tuple(map(typing.argument, parts))
        if kernel.own is not None:
            edges = user_edges({p: typing.table[p] for p in parameters}, results, written, edges,
                              self.residual_parameters(kernel))
        return UnitSummary(tuple(k for k, p in enumerate(parameters) if p in written), results,
                       {k: p.id for k, p in enumerate(parts) if isinstance(p, Name) and p.id in parameters
                        and typing.of(p).is_array},
                       tuple(edges), not guards and all(self.of_call(c, typing).summary.pure for c in calls))

    def residual_parameters(self, kernel: Kernel) -> tuple[str, ...] | None:
        """The parameters of the residual of an implicit function; None for any other function."""
        return self.program.kernels[kernel.residual].parameters if kernel.residual else None

    def of_call(self, called: Call, typing: Typing) -> Unit:
        return self.unit(user_call(called) or "", tuple(map(typing.argument, called.args)))

    def call_types(self, kernel: str, types: tuple[Type, ...]) -> tuple[Type, ...]:
        return self.unit(kernel, types).summary.results

    def written_in(self, tree: FunctionDef) -> set[str]:
        """The arrays that a function may store to."""
        return stored_arrays(tree, self)


def _types_of_single_bindings(types: Mapping[str, Type], function: FunctionDef) -> dict[str, Type]:
    """The types without those of parameters that are rebound, which may have another type then."""
    anew = {p.id for p in function.args.args} & set(stored_names(function.body))
    return {n: t for n, t in types.items() if n not in anew}
