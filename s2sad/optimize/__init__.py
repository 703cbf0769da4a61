"""optimize: loop transformations.

KERNELS runs on a kernel for Numba before it is differentiated. PASSES is for the level "fast": a finished derivative
comes in, and one with the same values up to rounding (`CHANGES_ROUNDING`) goes out, in which loops run in vectors and
whole arrays are gone through less often. A tangent for Numba, and a primal, only have their indices split.
"""
from __future__ import annotations

from s2sad.normalize import in_arrays, in_loops
from s2sad.optimize.blocked_products import blocked_products
from s2sad.optimize.extremum_scatter import extremum_scatter
from s2sad.optimize.index_set_splitting import index_set_splitting
from s2sad.optimize.inlining import inlining
from s2sad.optimize.invariant_code_motion import invariant_code_motion
from s2sad.optimize.known_positions import known_positions
from s2sad.optimize.loop_fusion import loop_fusion
from s2sad.optimize.loop_interchange import loop_interchange
from s2sad.optimize.loop_memoization import loop_memoization
from s2sad.optimize.primal_contraction import primal_contraction
from s2sad.optimize.shared_reciprocals import shared_reciprocals
from s2sad.optimize.shape_propagation import shape_propagation
from s2sad.optimize.strength_reduction import strength_reduction
from s2sad.optimize.unsigned_indices import unsigned_indices
from s2sad.optimize.vector_math import vector_math
from s2sad.optimize.vectorize import vectorize
from s2sad.passes import Pass, Passes
from s2sad.simplify.context import DerivativeContext
from s2sad.simplify.dead_code import dead_code


def in_adjoint(context: DerivativeContext) -> bool:
    return context.adjoint


def in_adjoint_loops(context: DerivativeContext) -> bool:
    return context.adjoint and context.in_loops


KERNELS: Passes = (
    Pass(primal_contraction, when=in_loops, form="views"),
)
PASSES: Passes = (
    Pass(inlining, when=in_adjoint_loops),
    Pass(known_positions, when=in_adjoint_loops),
    Pass(blocked_products, when=in_adjoint),
    Pass(invariant_code_motion, when=in_adjoint_loops),
    Pass(index_set_splitting, when=in_loops),
    Pass(loop_memoization, when=in_adjoint_loops),
    Pass(loop_fusion, when=in_adjoint_loops),
    Pass(loop_interchange, when=in_adjoint_loops),
    Pass(vectorize, when=in_adjoint_loops),
    Pass(vector_math, when=in_adjoint_loops),
    Pass(shared_reciprocals, when=in_adjoint_loops),
    Pass(shape_propagation, when=in_loops),
    Pass(dead_code, "dead_code_after_shapes", when=in_adjoint_loops),
    Pass(unsigned_indices, when=in_adjoint_loops),
    Pass(strength_reduction, when=in_arrays),
    Pass(extremum_scatter, when=in_arrays),
)

__all__ = ["KERNELS", "PASSES"]
