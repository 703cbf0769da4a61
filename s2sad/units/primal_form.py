"""primal_form: the kernel as it is run, beside the form that is differentiated: under Numba whole-array statements are
loops in both, but only what is run may fill arrays that no derivative sees.

Requires resolved views; changes nothing: the context has the function (`lowered`) and the types of its names.
"""
from __future__ import annotations

from dataclasses import replace

from s2sad.naming import Names
from s2sad.normalize.context import NormalContext
from s2sad.normalize.loops.scalarize import scalarize_final
from s2sad.passes import Pass, Passes, run, unwatched
from s2sad.simplify.complex_division import complex_division
from s2sad.simplify.conditional_numbers import conditional_numbers
from s2sad.tree import FunctionDef

PASSES: Passes = (
    Pass(scalarize_final),
    Pass(conditional_numbers),
    Pass(complex_division),
)


def primal_form(function: FunctionDef, context: NormalContext) -> None:
    """Leaves the function that is run, in loops, in the context."""
    beside = replace(context, names=Names(context.names.taken), watch=unwatched)
    beside.report, beside.typing = context.report, context.typing.copy()
    context.lowered, context.lowered_types = run(PASSES, function, beside), beside.typing.table


def same_primal(function: FunctionDef, context: NormalContext) -> None:
    """Leaves the function itself as the one that is run in the context.

    Requires resolved views; changes nothing."""
    context.lowered, context.lowered_types = function, context.typing.copy().table
