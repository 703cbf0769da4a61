"""Kernels become units: the passes of `normalize` and `infer`, for each set of argument types once.

    a kernel, types -> structured -> functions -> in_step -> pieces -> views -> workspace -> scalarize -> handed
    -> rename -> atoms: Unit
"""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache

from s2sad.analyze.activity import activity, reach
from s2sad.analyze.structure import structure
from s2sad.diagnostics import Report
from s2sad.differentiate.own import own_edges
from s2sad.infer.infer import Typing, infer
from s2sad.infer.known import known
from s2sad.infer.shapes import shapes_of
from s2sad.infer.types import FLOAT, Type, of_value
from s2sad.naming import Names
from s2sad.normalize import structured
from s2sad.normalize.around import around
from s2sad.normalize.arrays_in_rows import arrays_in_rows
from s2sad.normalize.as_numpy import as_numpy
from s2sad.normalize.atoms import atoms
from s2sad.normalize.complexes import complexes, of_its_own
from s2sad.normalize.contracted import contracted, undotted
from s2sad.normalize.decided import decided, undecided
from s2sad.normalize.dtyped import dtyped
from s2sad.normalize.form import verify
from s2sad.normalize.inlined import Helpers, inlined, returned
from s2sad.normalize.operands import Operands
from s2sad.normalize.parts import parts
from s2sad.normalize.rename import rename
from s2sad.normalize.listed_rows import listed_rows
from s2sad.normalize.lives import lives
from s2sad.normalize.long_products import long_products
from s2sad.normalize.one_name import one_name
from s2sad.normalize.settled import unsettled
from s2sad.normalize.sharing import shared, specialised
from s2sad.normalize.solvers import solvers
from s2sad.normalize.spelled import spelled
from s2sad.normalize.strengths import Known, Strengths
from s2sad.normalize.together import together
from s2sad.normalize.told import told
from s2sad.normalize.widened import makes_singles, widened
from s2sad.program import Kernel, Program
from s2sad.simplify import Effect, Effects, Watch, unwatched
from s2sad.tree import Assert, Call, FunctionDef, Name, Raise, call_name, copy, name, stored_names, walk
from s2sad.units.array_forms import ArrayForms
from s2sad.units.calls import Calls, written_arrays
from s2sad.units.unit import Summary, Unit


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

    def __post_init__(self) -> None:
        self.program = replace(self.program, kernels=dict(self.program.kernels))    # more are made on the way
        self.titles.taken |= set(self.program.kernels)
        self.arrays = ArrayForms(
            self.program, self.engine, self.watch, self, self.of_call, self.with_titles, self.apart)
        self.helpers, self.known = Helpers(self.program, plain_form), Known()
        self.singles = any(makes_singles(k.tree) for k in self.program.kernels.values()) or any(
            of_value(a).dtype == "float32" for a in self.program.arrays.values())

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
            first = unit.read_first()
            self.effects.table[title] = Effect(
                frozenset(k for k, p in enumerate(unit.function.args.args) if p.id in first),
                frozenset(unit.summary.written), unit.summary.pure,
                frozenset(k for k, t in enumerate(types) if t.is_array))
        return self.made[key]

    def _prepared(self, kernel: Kernel, types: tuple[Type, ...], title: str) -> Unit:
        """The passes of `normalize` and `infer`, in order."""
        if kernel.own is not None and "primal" in kernel.own.functions:
            return self._unread(kernel, types, title)
        names = Names()
        kernel, tree, typing = self._typed(kernel, types, names)
        tree, guarded, needed, typing, names = self.arrays.over_arrays(tree, typing, names)
        tree, lowered, numbers, lowered_types = self.arrays.for_engine(tree, typing, names)
        renamed = rename(tree, typing.table, names, self.call_writes)
        self.watch("rename", verify(renamed.function, "rename", "rename"))
        given, report = dict(zip((p.id for p in tree.args.args), types)), typing.report
        table = infer(renamed.function, given, self.call_types, report, typing.constants)
        report.finish()
        typing = Typing({**table, **given}, self.call_types, report, typing.constants)
        tree = self.with_titles(renamed.function, typing, report)
        tree = verify(atoms(tree, typing, names, written_arrays(tree, self)), "atoms", "atoms")
        self.watch("atoms", tree)
        known(tree, typing, report)
        report.finish()
        typing = self.apart(typing)     # without what it remembers of trees that are gone
        typing.runs_once = self.runs_once
        once = kernel.own is not None or any(self.runs_once(n) for n in walk(tree.body) if isinstance(n, Call))
        return Unit(kernel, title, types, tree, typing, dict(renamed.family), names, lowered, structure(tree, typing),
                    self._summary(tree, typing, kernel), guarded, once=once, numbers=numbers,
                    lowered_types=_of_one_life(lowered_types, lowered),
                    contiguous=tuple(k for k, p in enumerate(tree.args.args) if p.id in needed))

    def _typed(self, kernel: Kernel, types: tuple[Type, ...], names: Names) -> tuple[Kernel, FunctionDef, Typing]:
        """The kernel in structured form, with the types of its names; what it calls that returns arrays is in it."""
        values = {**self.program.constants, **self.program.arrays}
        tree = verify(plain_form(kernel, names, self.program), "structured", "spelled")
        given = dict(zip((p.id for p in tree.args.args), types))
        tree, source = inlined(decided(tree, given), given, names, kernel.source, self.helpers)
        kernel, report = replace(kernel, source=source), Report(source)
        undecided(tree, report)
        report.finish()
        self.watch("structured", tree)
        together(*self.helpers.typing(tree, given, source, Names(names.taken)), report)
        report.finish()
        tree, table = self._widened(tree, given, report, names)
        typing = Typing({**table, **given}, self.call_types, first := Report(source), values)
        tree = long_products(told(tree, typing), typing, names)
        Operands(tree, typing, first).everywhere(tree.body)
        first.finish()
        complexes(tree, typing, first)      # these say more than that a type cannot be inferred
        of_its_own(kernel, types, first)
        first.finish()
        report.finish()
        typing = Typing({**typing.table, **given}, self.call_types, report, values)
        typing.final = True
        return kernel, tree, typing

    def _widened(self, tree: FunctionDef, given: dict[str, Type], report: Report,
                 names: Names) -> tuple[FunctionDef, dict[str, Type]]:
        """The kernel with a name for each life of one, and the types, which are NumPy's."""
        values = {**self.program.constants, **self.program.arrays}
        while True:
            said = Report(report.source)
            tree, table = lives(tree, given, self.call_types, said, values, names)
            tree = one_name(tree)
            typing = Typing({**table, **given}, self.call_types, Report(report.source), values)
            if (asked := dtyped(tree, typing)) is not tree:
                tree = asked
                continue
            arrays_in_rows(tree, typing, self.program, lambda called, typing=typing: self.of_call(
                called, typing).summary.written, report)
            plain = undotted(listed_rows(tree, typing, self.helpers, report), typing)
            report.finish()
            if plain is not tree:
                tree = plain
                continue
            strengths = Strengths(self.helpers, typing, self.known)
            singles = self.singles or any(t.dtype == "float32" for t in typing.table.values())
            wider = widened(tree, typing, strengths.results) if singles else None
            if wider is None:
                if singles:
                    strengths.refuse(tree, said)
                report.found += said.found
                return tree, table
            tree = wider

    def _unread(self, kernel: Kernel, types: tuple[Type, ...], title: str) -> Unit:
        """The unit of a function that is called as it is, of which is known what the user says."""
        own, tree = kernel.own, kernel.tree
        assert own is not None
        of_its_own(kernel, types, report := Report(kernel.source))
        report.finish()
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

    def of_call(self, called: Call, typing: Typing) -> Unit:
        return self.unit((call_name(called) or "").partition(".")[2], tuple(map(typing.argument, called.args)))

    def call_types(self, kernel: str, types: tuple[Type, ...]) -> tuple[Type, ...]:
        return self.unit(kernel, types).summary.results

    def with_titles(self, tree: FunctionDef, typing: Typing, report: Report) -> FunctionDef:
        """The tree with every kernel's call naming the unit for its arguments: their types, and which are one array."""
        new = copy(tree)
        places = cache(lambda: around(new.body, shapes_of(tree, typing)))
        for node in walk(new.body):
            if not isinstance(node, Call) or not (call_name(node) or "").startswith("user."):
                continue
            unit = self.of_call(node, typing)
            pairs = shared(node, unit.summary.written, typing, places, report)
            if pairs:
                node.args = [a for k, a in enumerate(node.args) if all(k != gone for gone, _ in pairs)]
                unit = self.unit(unit.kernel.name, tuple(map(typing.argument, node.args)), pairs)
            node.func = name(f"user.{unit.title}")
        return new


def _of_one_life(types: dict[str, Type], function: FunctionDef) -> dict[str, Type]:
    """The types without those of parameters that are bound anew, which may be of another type then."""
    anew = {p.id for p in function.args.args} & set(stored_names(function.body))
    return {n: t for n, t in types.items() if n not in anew}


def plain_form(kernel: Kernel, names: Names, program: Program) -> FunctionDef:
    """A kernel in structured form, before types are known."""
    report = Report(kernel.source)
    tree = solvers(as_numpy(structured(kernel, names, program)), report)
    report.finish()
    tree = spelled(contracted(parts(tree, names)))
    unsettled(tree, report)
    report.finish()
    return tree
