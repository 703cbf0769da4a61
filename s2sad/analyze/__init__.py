"""analyze: what must be differentiated, what must be recorded, and where recorded values come back.

In comes a kernel in normal form and a request; out goes the tree, and a table from each analysis in its context
(`AnalysisContext`), in this order:

    named_choices           for an adjoint: names for what decides choices, in another tree
    program_structure       where each statement stands
    activity                what carries a derivative from an input to an output
    unsupported_derivatives refuses what a derivative of the user's own does not give
    unbounded_values        what can be infinite or nan, and where a choice may leave that
    to_be_recorded          for an adjoint: what is recorded, what is computed again, which loops run again
    entry_dtypes            for an adjoint: what takes less on the tape than where it was
    commuting_iterations    for an adjoint in loops: those that may run forwards

The tables read the tree by the identity of its nodes, and so hold for this very tree. `missing_shadows` is an analysis
for messages, asked after a derivative has been made.
"""
from __future__ import annotations

from s2sad.analyze.activity import activity
from s2sad.analyze.commuting_iterations import commuting_iterations
from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.tape_entries.entry_dtypes import entry_dtypes
from s2sad.analyze.named_choices import named_choices
from s2sad.analyze.program_structure import program_structure
from s2sad.analyze.to_be_recorded import to_be_recorded
from s2sad.analyze.unbounded_values import unbounded_values
from s2sad.analyze.unsupported_derivatives import unsupported_derivatives
from s2sad.passes import Pass, Passes


def backwards(context: AnalysisContext) -> bool:
    return context.mode == "adjoint"


def backwards_in_loops(context: AnalysisContext) -> bool:
    return backwards(context) and context.in_loops


ACTIVITY: Passes = (
    Pass(program_structure),
    Pass(activity),
    Pass(unsupported_derivatives),
    Pass(unbounded_values),
)
PASSES: Passes = (
    Pass(named_choices, when=backwards),
    *ACTIVITY,
    Pass(to_be_recorded, when=backwards),
    Pass(entry_dtypes, when=backwards),
    Pass(commuting_iterations, when=backwards_in_loops),
)

__all__ = ["ACTIVITY", "PASSES", "AnalysisContext", "backwards"]
