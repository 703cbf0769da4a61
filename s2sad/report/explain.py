"""explain: what was found about a derivative, as text, as JSON and as a page."""
from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from html import escape
from typing import Any

from s2sad import pipeline
from s2sad.dispatch.arguments import kernel_value
from s2sad.interface.pytrees import Carrier, flat_call
from s2sad.live_objects.guards import current
from s2sad.normalize.calls.global_arrays import hidden_arrays, hidden_name
from s2sad.program import Evaluation, Generated, Program, Request
from s2sad.live_objects.unwrap import apply_functions
from s2sad.report.findings import Findings, FoundPlace, findings
from s2sad.report.listing import Listing, listings
from s2sad.report.page import page
from s2sad.run.memory import Footprint, LoopRuns, byte_text, footprint_of, loop_runs
from s2sad.run.compiled import chosen
from s2sad.interface.selection import Wrt, names_of, selected_of, selected_wrt
from s2sad.run.tracebacks import public
from s2sad.dispatch.cache import derivatives_of
from s2sad.dispatch.snapshot_plan import SnapshotPlan, snapshot_plan


@dataclass(frozen=True)
class Explanation:
    """The report: `str(it)` is text, `it.json()` the same facts as JSON, `it.html()` a page that needs nothing else.

    `functions` has the entry's facts first, then those of every derivative that it calls; a notebook shows the page.
    """
    title: str
    functions: tuple[Findings, ...]
    listings: tuple[Listing, ...]
    evaluated: tuple[str, ...] = ()         # what was computed before the run, a line each
    taken: Footprint | None = None          # the memory of a call with the arguments
    runs: tuple[LoopRuns, ...] = ()         # of the steps of loops that keep snapshots
    plan: SnapshotPlan | None = None        # by which these were chosen

    def __str__(self) -> str:
        chosen = [] if self.plan is None else [str(self.plan)]
        head = "\n".join([f"{self.title}\nrecords {self.tape}", *map(str, self.runs), *chosen])
        if self.evaluated:
            head += "\n\n" + "\n".join(["computed before the run", *(f"  {line}" for line in self.evaluated)])
        return "\n\n".join([head, *("\n".join(_lines(f)) for f in self.functions)])

    @property
    def bytes(self) -> int | None:
        """The bytes that are recorded at one time, as far as they are known; None where none are."""
        stacks = [s for f in self.functions for s in f.recorded]
        if self.taken is None or stacks and all(s.grows or s.bytes is None for s in stacks):
            return None
        return self.taken.recorded

    @property
    def tape(self) -> str:
        """What is recorded, in words."""
        stacks = [s for f in self.functions for s in f.recorded]
        if not stacks:
            return "nothing"
        grow = ", ".join(dict.fromkeys(s.name for s in stacks if s.grows))
        if self.bytes is None:
            sizes = [s.formula for s in stacks if not s.grows]
            plain = f"{' + '.join(sizes)} bytes" if len(sizes) < 4 else "as many bytes as follow from the arguments"
            return ", and ".join([*([plain] if sizes else []), *([f"what grows as it runs: {grow}"] if grow else [])])
        open_ends = ", ".join(dict.fromkeys(s.name for s in stacks if s.grows or s.bytes is None))
        return byte_text(self.bytes) + (f", and what is known only at run time: {open_ends}" if open_ends else "")

    def json(self) -> str:
        """The facts as JSON: {"title": ..., "bytes": ..., "evaluated": [...], "functions": [...]}."""
        functions = [asdict(f) for f in self.functions]
        return json.dumps({"title": self.title, "bytes": self.bytes, "evaluated": self.evaluated,
                           "functions": functions}, indent=2)

    def html(self) -> str:
        """A page with the functions and their adjoints side by side, linked line by line; it needs nothing else."""
        return page(self.title, self.tape, str(self), self.functions, self.listings)

    def _repr_html_(self) -> str:
        """What a notebook shows: the page, in a frame of its own."""
        return (f'<iframe srcdoc="{escape(self.html())}" sandbox="allow-scripts" title="{escape(self.title)}" '
                'style="width: 100%; height: 720px; border: 1px solid #8886"></iframe>')


@public
def explain(f: Callable[..., Any], *args: Any, wrt: Wrt = None,
            of: str | Iterable[str] | None = None, engine: str | None = None) -> Explanation:
    """What the adjoint of f for arguments of these types does, records and leaves out, and why.

    Args: args, f's arguments (only types, shapes and numbers are read; nothing is run or changed); wrt, of and engine
    as for `differentiate` (default: what f carries, if it is differentiated). The report is an `Explanation`: for
    every function of the generated file every recorded value, the largest first, with its bytes and the statement that
    needs it, the verdict for every variable, what is computed again instead, what the forward sweep leaves out, the
    loops that run forward and back per iteration, and every place where f is not differentiable.
    Raises S2sadError as `f.adjoint` does before anything runs.
    Literature: Hascoet, Naumann, Pascual, "To be recorded" analysis in reverse-mode AD, FGCS 21, 2005.

    >>> import numpy as np
    >>> def energy(u):
    ...     for i in range(u.size):
    ...         u[i] = u[i] * u[i]
    ...     return np.sum(u * u)
    >>> print(explain(energy, np.ones(5), engine="numpy"))  # doctest: +ELLIPSIS
    Adjoint of energy: d(u, return) / d(u), engine numpy
    records 40 bytes
    <BLANKLINE>
    energy_adjoint
      recorded
        u_stack: 40 bytes = 8 * u.size bytes, u before `u[i] = u[i] * u[i]`
          needed by line 3: u[i] = u[i] * u[i]
      variables
        u: float64[:], active
        i: int64, inactive: int64 has no derivative
    ...
    """
    carrier = Carrier.with_overrides(f, names_of(wrt, f), names_of(of, f, "of"), engine)
    function, args, _ = apply_functions(f, args, {})
    state, arguments, carried = flat_call(derivatives_of(function).state(), carrier, args)
    values = [kernel_value(n, v, n in state.floats) for n, v in zip(state.parameters, arguments)]
    types, name = state.types(values), state.kernel.name
    of = selected_of(name, state.parameters, types, state.summary(types), carried.of)
    request = Request("adjoint", types, selected_wrt(name, state.parameters, types, carried.wrt), of,
                      chosen(carried.engine), recording=carried.recording)
    return explain_program(state.program, request, dict(zip(state.parameters, values)))


def explain_program(program: Program, request: Request, arguments: Mapping[str, Any] | None = None) -> Explanation:
    """The report on a program and a request; with arguments by name also on the bytes these take."""
    plan, recording = None, request.recording
    if recording.limit and arguments:
        plan = snapshot_plan(program.entry, recording.limit, 0, lambda loops: pipeline.derive(program, replace(
            request, recording=recording.keeping(loops))), lambda made: _taken(program, made, arguments))
        request = replace(request, recording=recording.keeping(plan.checkpoints))
    made = pipeline.derive(program, request)
    units, entry = made.facts["units"], made.facts["derived"]
    taken = None if arguments is None else _taken(program, made, arguments)
    derived = [entry, *(d for d in units.derived.values() if d is not entry)]
    title = (f"{request.mode.capitalize()} of {entry.unit.kernel.name}: d({', '.join(request.of) or 'nothing'}) / "
             f"d({', '.join(request.wrt) or 'nothing'}), engine {request.engine}")
    found = tuple(findings(d, taken, request.engine) for d in derived)
    evaluated = () if program.evaluation is None else tuple(_evaluated(program.evaluation, program))
    return Explanation(title, found, listings(program, made, {f.name: f for f in found}), evaluated, taken,
                       () if taken is None else loop_runs(made, taken), plan)


def _taken(program: Program, made: Generated, arguments: Mapping[str, Any]) -> Footprint:
    """The memory of a call with these arguments."""
    units, entry = made.facts["units"], made.facts["derived"]
    outside = {hidden_name(p, units.program): current(program.arrays[a])
               for p, a in hidden_arrays(units.program).items()}
    parameters = [hidden_name(p.id, units.program) for p in entry.unit.function.args.args]
    return footprint_of(made, {**arguments, **outside}, {parameters[k] for k in entry.unit.summary.written})


def _evaluated(found: Evaluation, program: Program) -> Iterator[str]:
    """What the evaluator has computed away, and what would make another derivative."""
    yield from (f"{path} is the parameter {parameter}" for parameter, path in found.parameters.items())
    own = program.kernels[program.entry].source.path
    for place, rounds in found.unrolled:
        text = place_text(FoundPlace(place.line, place.text.strip(), "" if place.path == own else place.path))
        yield f"written out, {rounds} rounds: {text}"
    for (path, what), value in found.facts:
        said = getattr(value, "__name__", None) or repr(value)
        known = f"{path} = {said}" if what == "value" else f"{path}.shape = {said}" if what == "shape" else (
            f"{path} {what}" if value else f"not {path} {what}")
        yield f"made for {known}; anything else makes another derivative"


# -- text -----------------------------------------------------------------------------------------------------------

def _lines(found: Findings) -> list[str]:
    lines = [found.name, *([] if found.recorded else ["  recorded: nothing"])]
    lines += ["  recorded"] if found.recorded else []
    for stacked in found.recorded:
        lines.append(f"    {stacked.name}: {stacked.size}, {stacked.what}")
        lines += [f"      needed by {place_text(p)}" for p in stacked.needed_by]
    lines.append("  variables")
    lines += [f"    {v.variable}: {v.type + ', ' if v.type else ''}{v.reason}" for v in found.variables]
    lines += _section("computed again instead of recorded", [
        f"{a.variable}: {a.how}, {place_text(a.place)}" for a in found.again])
    lines += _section("left out of the forward sweep", [place_text(p) for p in found.dropped])
    lines += _section("run in the reverse sweep only", [place_text(p) for p in found.reversed_again])
    lines += _section("loops run forward and back per iteration", [place_text(p) for p in found.loops])
    lines += _section("not differentiable", [f"{place_text(k.place).rstrip(':')}: {k.what}" for k in found.kinks])
    if found.interpreted:
        lines += _section("run by the interpreter, which Numba's code calls",
                          [place_text(p) for p in found.interpreted])
    return lines


def _section(title: str, lines: list[str]) -> list[str]:
    return [f"  {title}", *(f"    {line}" for line in lines)] if lines else [f"  {title}: nothing"]


def place_text(place: FoundPlace) -> str:
    return f"{place.path}:{place.line}: {place.text}" if place.path else f"line {place.line}: {place.text}"
