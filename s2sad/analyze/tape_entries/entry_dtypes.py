"""entry_dtypes: what takes less on the tape than where it was.

Requires the plan of what is recorded; establishes its `dtypes`. Flags are bytes by their type, and integers from narrow
arrays as narrow as these; others take what is proven to be enough for them (`integer_ranges`). Floats are as they were,
or rounded where that is asked for and decides nothing (`rounded_values`); what is left then has its reason in `exact`.
"""
from __future__ import annotations

from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.tape_entries.integer_ranges import integer_ranges
from s2sad.analyze.tape_entries.rounded_values import rounded_values
from s2sad.tree import FunctionDef


def entry_dtypes(function: FunctionDef, context: AnalysisContext) -> None:
    """Leaves the dtypes of narrower entries in the plan."""
    assert context.plan is not None
    context.plan.dtypes = integer_ranges(context.structure, context.plan)
    if context.tape_dtype == "float32":
        rounded, context.plan.exact = rounded_values(context)
        context.plan.dtypes |= rounded
