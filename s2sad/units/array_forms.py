"""Whole arrays in a kernel: statements over arrays and parts of them by their own names, and for Numba loops.

    structured -> functions -> in_step -> pieces -> views -> workspace -> scalarize -> handed
"""
from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import dataclass

from s2sad.analyze.liveness import base_name
from s2sad.diagnostics import Report, S2sadError
from s2sad.differentiate.arithmetic import scalar_choices
from s2sad.infer.infer import Typing
from s2sad.infer.types import FLOAT, Type
from s2sad.naming import Names
from s2sad.normalize.aliases import SHARED
from s2sad.normalize.choices import choices
from s2sad.normalize.contiguous import Contiguity, demanded, of_calls
from s2sad.normalize.contracted import REPEATING, batched
from s2sad.normalize.exchanged import exchanged
from s2sad.normalize.factored import factored
from s2sad.normalize.form import verify
from s2sad.normalize.functions import functions
from s2sad.normalize.in_step import in_step
from s2sad.normalize.integers import integers
from s2sad.normalize.pieces import pieces
from s2sad.normalize.rotated import rotated
from s2sad.normalize.rows import rows
from s2sad.normalize.ruled import ruled
from s2sad.normalize.scalarize import scalarize, scatter
from s2sad.normalize.sought import sought
from s2sad.normalize.stacked import stacked
from s2sad.normalize.tails import tails
from s2sad.normalize.unnamed import unnamed
from s2sad.normalize.viewing import viewing
from s2sad.normalize.views import views
from s2sad.normalize.workspace import workspace
from s2sad.program import Program
from s2sad.simplify import Watch
from s2sad.simplify.handed import handed
from s2sad.simplify.quotients import quotients
from s2sad.tree import Assert, Assign, Call, FunctionDef, call_name, copy, times_bound, walk
from s2sad.units.calls import Calls
from s2sad.units.unit import Unit


@dataclass
class ArrayForms:
    """The forms of the kernels of one program for one engine; `of_call` makes the unit that a call calls, `with_titles`
    names those of a function, `apart` gives a table of types of its own."""
    program: Program
    engine: str
    watch: Watch
    calls: Calls
    of_call: Callable[[Call, Typing], Unit]
    with_titles: Callable[[FunctionDef, Typing, Report], FunctionDef]
    apart: Callable[[Typing], Typing]

    def over_arrays(self, tree: FunctionDef, typing: Typing,
                    names: Names) -> tuple[FunctionDef, bool, set[str], Typing, Names]:
        """What `_over_arrays` gives, with the types and the names that it has then; where it refuses names that stand
        for one array or another, with what follows a branch in its sides."""
        known, kept = self.apart(typing), names.copy()
        known.report, known.final = Report(typing.report.source), typing.final
        try:
            return *self._over_arrays(tree, typing, names), typing, names
        except S2sadError as refused:
            def written(called: Call) -> tuple[int, ...]:
                return self.of_call(called, known).summary.written
            shared = any(d.message == SHARED for d in refused.diagnostics)
            moved = tails(exchanged(tree, known, written), known, written) if shared else tree
            if moved is tree:
                raise
            again = {n for n, times in times_bound(tree.body, Assign).items() if times > 1}
            try:
                return *self._over_arrays(moved, known, kept, again), known, kept
            except S2sadError:
                raise refused from None

    def _over_arrays(self, tree: FunctionDef, typing: Typing, names: Names,
                     swapped: Set[str] = frozenset()) -> tuple[FunctionDef, bool, set[str]]:
        """The kernel with whole-array statements over arrays and parts of them by their own names, whether guards of
        shapes were added, and the parameters that must be contiguous; `swapped` names may stand for other arrays."""
        report = typing.report
        tree = integers(tree, typing, self.engine == "numba")
        tree = stacked(rotated(tree, typing, names), typing)

        def written(called: Call) -> tuple[int, ...]:
            return self.of_call(called, typing).summary.written
        tree = rows(tree, typing, self.program, written, report)
        report.finish()
        repeating = any(call_name(n) == REPEATING for n in walk(tree.body))
        tree = sought(batched(choices(tree, typing, names), typing), typing, self.engine == "numba")
        ruled(tree, typing, report)
        report.finish()
        tree = functions(tree, typing, names, self.engine == "numba")

        def arrays(called: Call) -> list[str]:
            return [base_name(called.args[k]) for k in written(called)]
        lying = Contiguity(tree, typing, {*swapped, *typing.listed, *self.results(tree)})
        tree, needed = in_step(tree, typing, names, arrays, lying)
        viewing(tree, typing, arrays, report)
        needed |= of_calls(tree, lying, lambda called: self.of_call(called, typing).contiguous, report)
        plain = tree = pieces(tree, typing, names, report)
        report.finish()
        tree = views(tree, typing.table, typing, names, written, report, self.engine == "numba")
        report.finish()
        guarded = repeating or count(tree, Assert) > count(plain, Assert)
        unnamed(tree, report)
        report.finish()
        tree = demanded(tree, needed)
        self.watch("views", tree)
        tree = verify(self.with_titles(workspace(tree), typing, report), "views", "workspace")
        report.finish()
        self.watch("workspace", tree)
        return tree, guarded, needed

    def results(self, tree: FunctionDef) -> list[str]:
        """The arrays that take what functions return."""
        return [base_name(a) for n in walk(tree.body) if isinstance(n, Call)
                for room, _, kernel in [(call_name(n) or "").partition(".")] if room == "user"
                if kernel in self.program.kernels
                for a in n.args[len(n.args) - self.program.kernels[kernel].results:]]

    def for_engine(self, tree: FunctionDef, typing: Typing,
                   names: Names) -> tuple[FunctionDef, FunctionDef, dict[str, str], dict[str, Type]]:
        """The form that is differentiated, the primal, the arrays in whose place the form has numbers, and the types of
        the primal's names: for Numba whole-array statements are loops."""
        apart = self.apart(typing)
        if self.engine == "numba":
            lowered = scalarize(tree, apart, Names(names.taken), final=True)
            lowered = quotients(with_choices(lowered, apart), apart)
            tree = verify(scalarize(factored(tree, typing, names), typing, names), "views", "scalarize")
            writing = {call_name(n) or "" for n in walk(tree.body) if isinstance(n, Call) and self.calls.call_writes(n)}
            self.watch("scalarize", tree)
            tree, numbers = handed(tree, typing.table, names, writing)
            typing.table.update(dict.fromkeys(numbers, FLOAT))
            self.watch("handed", verify(tree, "views", "handed"))
            return tree, lowered, numbers, apart.table
        tree = verify(scatter(tree, typing, names), "views", "scatter")
        self.watch("scalarize", tree)
        return tree, tree, {}, apart.table


def with_choices(function: FunctionDef, typing: Typing) -> FunctionDef:
    """A function with every `np.where` of numbers and elements as a choice; one of arrays may be left in what is
    returned."""
    new = copy(function)
    new.body = [scalar_choices(s, lambda n: not typing.of(n).is_array) for s in new.body]
    return new


def count(function: FunctionDef, kind: type) -> int:
    """How many statements of a kind a function has."""
    return sum(isinstance(n, kind) for n in walk(function.body))
