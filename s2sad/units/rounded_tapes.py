"""rounded_tapes: a program of which nothing can be recorded in single precision is refused where that is asked for."""
from __future__ import annotations

from s2sad.analyze.tape_entries.rounded_values import ROUNDED
from s2sad.diagnostics import Report
from s2sad.units.unit_derivatives import Units


def refuse_unrounded(units: Units) -> None:
    """Raises S2sadError (S408) if floats of double precision are recorded, and all of them decide something."""
    plans = [(d.unit.kernel.source, d.plan) for d in units.derived.values() if d.plan is not None]
    if any(dtype in ROUNDED.values() for _, plan in plans for dtype in plan.dtypes.values()):
        return
    for source, plan in plans:
        if plan.exact:
            report = Report(source)
            report.error("S408", "tape_dtype='float32' would round what decides this, and nothing else is recorded",
                         min(plan.exact.values(), key=lambda s: (s.lineno, s.col_offset)),
                         help="record float64, and keep snapshots where the tape is too large: checkpoint={...}")
            report.finish()
