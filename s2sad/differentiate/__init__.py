"""differentiate: normal form becomes an adjoint or a tangent, statement by statement.

In comes a kernel in normal form with the tables of `analyze`; out goes the function of one derivative, in the grammar
"derivative" of `form`, and its signature (`DifferentiationContext.derivative`). One of the two passes runs:

    adjoint     forward sweep, then blocks of the reverse sweep that restore, compute again and take adjoints
    tangent     each statement with its tangent beside it

A function with a derivative of the user's own has no such passes: `user_derivative` makes the function that calls it.
"""
from __future__ import annotations

from s2sad.analyze import backwards
from s2sad.differentiate.adjoint import adjoint
from s2sad.differentiate.context import DifferentiationContext
from s2sad.differentiate.tangent import tangent
from s2sad.passes import Pass, Passes


def forwards(context: DifferentiationContext) -> bool:
    return not backwards(context)


PASSES: Passes = (
    Pass(adjoint, when=backwards, form="derivative"),
    Pass(tangent, when=forwards, form="derivative"),
)

__all__ = ["PASSES", "DifferentiationContext"]
