"""bounds: for which arguments the kernels of a program stay within their arrays."""
from __future__ import annotations

from s2sad.analyze.index_bounds import index_bounds
from s2sad.infer.index_systems import IndexBounds
from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.normalize.calls.global_arrays import hidden_name
from s2sad.program import IndexLimit
from s2sad.tree import Call
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
        unit.index_bounds = index_bounds(unit.lowered, typing, callee)
    return unit.index_bounds


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
