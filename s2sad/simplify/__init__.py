"""simplify: the derivative becomes shorter and computes the same.

In comes what `differentiate` has made; out goes a function with the same values, exactly where a pass does not say
that it `CHANGES_ROUNDING`. LOWERED brings it into the form in which the engine runs it, PASSES shorten it: zeros merge
with the first addition, what is dead goes, versions of a variable come under one name, names are folded into their one
use; for loops short branches become choices and gains are joined, for whole arrays nothing is computed twice.
"""
from __future__ import annotations

from s2sad.normalize import in_arrays, in_loops
from s2sad.normalize.array_anf import array_anf_added
from s2sad.normalize.loops.scalarize import scalarize_final
from s2sad.passes import Pass, Passes
from s2sad.simplify.algebra import algebra
from s2sad.simplify.combine_increments import combine_increments
from s2sad.simplify.common_subexpressions import common_subexpressions
from s2sad.simplify.complex_division import complex_division
from s2sad.simplify.conditional_numbers import conditional_numbers
from s2sad.simplify.context import DerivativeContext, InlinedFunction
from s2sad.simplify.copy_coalescing import copy_coalescing, share_temporaries, split_temporaries
from s2sad.simplify.copy_elision import copy_elision
from s2sad.simplify.dead_code import dead_code
from s2sad.simplify.dead_stores import dead_stores
from s2sad.simplify.call_effects import Effect, Effects
from s2sad.simplify.forward_substitution import forward_substitution
from s2sad.simplify.if_conversion import if_conversion
from s2sad.simplify.initialize_accumulators import initialize_accumulators
from s2sad.simplify.merge_branches import merge_branches
from s2sad.simplify.remove_marks import remove_marks
from s2sad.simplify.wide_accumulators import is_real, wide_accumulators, wide_numbers


def in_single_precision(context: DerivativeContext) -> bool:
    return context.has_float32


def in_single_arrays(context: DerivativeContext) -> bool:
    return context.has_float32 and not context.in_loops and is_real(context.typing)


LOWERED: Passes = (
    Pass(wide_accumulators, when=in_single_precision),
    Pass(dead_code, "dead_code_in_arrays", when=in_loops),
    Pass(array_anf_added, when=in_loops),
    Pass(scalarize_final, when=in_loops),
    Pass(conditional_numbers, when=in_loops),
)
PASSES: Passes = (
    Pass(initialize_accumulators),
    Pass(dead_code),
    Pass(dead_stores),
    Pass(dead_code, "dead_code_after_stores"),
    Pass(copy_coalescing),
    Pass(merge_branches),
    Pass(split_temporaries),
    Pass(forward_substitution),
    Pass(algebra),
    Pass(initialize_accumulators, "initialize_after_algebra"),
    Pass(if_conversion, when=in_loops),
    Pass(initialize_accumulators, "initialize_after_if_conversion", when=in_loops),
    Pass(combine_increments, when=in_loops),
    Pass(copy_elision),
    Pass(common_subexpressions, when=in_arrays),
    Pass(dead_code, "dead_code_at_end"),
    Pass(remove_marks),
    Pass(share_temporaries),
    Pass(complex_division, when=in_loops),
    Pass(wide_numbers, when=in_single_arrays),
)

__all__ = ["LOWERED", "PASSES", "DerivativeContext", "Effect", "Effects", "InlinedFunction"]
