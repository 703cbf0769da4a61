"""bounds: for which arguments the kernels of a program stay within their arrays, and what arguments decide it."""
from __future__ import annotations

from s2sad.analyze.index_bounds import index_bounds
from s2sad.analyze.tape_entries.decision_reads import DecisionReads, deciding_parameters
from s2sad.infer.index_systems import IndexBounds
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.liveness import targets
from s2sad.normalize.calls.global_arrays import hidden_name
from s2sad.program import IndexLimit
from s2sad.runtime.random_sequences import FUNCTIONS
from s2sad.tree import Assign, AugAssign, Call, call_name, walk, walk_statements
from s2sad.units.unit import Unit
from s2sad.units.unit_derivatives import Units


def bounds_of(unit: Unit, units: Units) -> IndexBounds | None:
    """The bounds of a kernel with all that it calls, None for a function that is not read."""
    if unit.kernel.own is not None:
        return None
    if unit.index_bounds is None:
        def callee(node: Call) -> IndexBounds | None:
            called = units.callee(node)
            return None if called is None else bounds_of(called, units)
        typing = Typing(unit.lowered_types, units.call_types, Report(unit.kernel.source), unit.typing.constants)
        parameters = [p.id for p in unit.lowered.args.args]
        unit.index_bounds = index_bounds(unit.lowered, typing, callee, {parameters[k] for k in unit.summary.written})
    return unit.index_bounds


_DRAWS = frozenset(f"runtime.{f.__name__}" for f in FUNCTIONS)


def decided_by_integers(unit: Unit, units: Units) -> bool:
    """Whether the entry's sizes, integers and arrays of integers alone decide which elements a program asks for: no
    float does, nothing that is drawn, and no function that is not read."""
    every = units.titled.values()
    if any(u.kernel.own is not None or u.kernel.residual for u in every) or any(
            (call_name(n) or "").startswith("given.") or call_name(n) in _DRAWS for u in every
            for n in walk(u.function.body)):
        return False
    if any(map(_rounds, every)):
        return False
    deciding = deciding_parameters(unit.function, DecisionReads(unit.typing, units, {}))
    return not any(unit.types[k].is_inexact for k in deciding)


def _rounds(unit: Unit) -> bool:
    """Whether a kernel stores floats as integers."""
    of = unit.typing.of
    return any(isinstance(s, (Assign, AugAssign)) and of(s.value).is_inexact and any(
        of(t).kind in ("number", "array") and not of(t).is_inexact for t in targets(s))
        for s in walk_statements(unit.function.body))


def index_limits(unit: Unit, units: Units) -> tuple[tuple[IndexLimit, ...], ...] | None:
    """The bounds of the entry for calls: for each system its forms. None where no arguments are known to stay within
    bounds."""
    found = bounds_of(unit, units)
    if found is None or found.never_known:
        return None
    names = [hidden_name(p.id, units.program) for p in unit.function.args.args]
    limits = (tuple(IndexLimit(tuple((names[found.parameters[s][0]], found.parameters[s][1], c) for s, c in form.terms),
                               form.constant) for form in system) for system in found.systems)
    return tuple(sorted(limits, key=repr))


def index_facts(unit: Unit, units: Units) -> dict[str, object]:
    """What calls of the entry ask of their arguments before they run."""
    return {"index_limits": index_limits(unit, units), "decided_by_integers": decided_by_integers(unit, units)}
