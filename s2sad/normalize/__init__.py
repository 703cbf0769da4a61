"""normalize: the tree of a kernel becomes normal form, whose grammar stands in `form`.

In comes a kernel's tree with resolved names, in the supported subset; out goes, for given types of arguments, a
function of single assignments over arrays and numbers, with the types of all its names. Its phases, in order:

    STRUCTURE   one target a statement, one exit, loops that count; types play no part
    CALLS       functions of NumPy and SciPy under one spelling
    TYPES       callees that return arrays inlined, the type of each name, what types decide
    ARRAYS      functions of whole arrays stand alone; every array is named by its buffer and its subscripts
    LOOPS       for an engine that compiles loops whole-array statements become loops
    NUMBERS     one name a binding, one operation a statement where an adjoint needs it
"""
from __future__ import annotations

from s2sad.naming import Names
from s2sad.normalize.anf import anf
from s2sad.normalize.array_anf import array_anf
from s2sad.normalize.buffers.array_privatization import array_privatization
from s2sad.normalize.buffers.argument_rotation import argument_rotation
from s2sad.normalize.buffers.bounds_check_elimination import bounds_check_elimination
from s2sad.normalize.buffers.resolve_views import resolve_views
from s2sad.normalize.buffers.shared_buffers import swap_contents, tail_duplication
from s2sad.normalize.calls.callee_units import callee_units
from s2sad.normalize.calls.inline import inline
from s2sad.normalize.calls.tuple_arguments import tuple_arguments
from s2sad.normalize.check_known import check_known
from s2sad.normalize.context import NormalContext
from s2sad.normalize.control.conditional_values import conditional_values
from s2sad.normalize.control.counted_loops import counted_loops
from s2sad.normalize.control.definite_assignment import definite_assignment
from s2sad.normalize.control.peel_first_iteration import peel_shared_array
from s2sad.normalize.control.single_exit import single_exit
from s2sad.normalize.control.single_target import single_target
from s2sad.normalize.dtypes.complex_support import complex_support
from s2sad.normalize.dtypes.operand_types import operand_types
from s2sad.normalize.dtypes.overflow import overflow
from s2sad.normalize.dtypes.requested_dtypes import requested_dtypes
from s2sad.normalize.dtypes.weak_results import has_float32, weak_results
from s2sad.normalize.expression_depth import expression_depth
from s2sad.normalize.library.array_literals import array_literals
from s2sad.normalize.library.canonical_calls import canonical_calls
from s2sad.normalize.library.differentiable import differentiable
from s2sad.normalize.library.einsum import batched_products, einsum, einsum_ellipsis
from s2sad.normalize.library.expand import expand
from s2sad.normalize.library.lu import lu
from s2sad.normalize.library.mgrid import mgrid
from s2sad.normalize.library.positional_arguments import positional_arguments
from s2sad.normalize.library.scipy_linalg import scipy_linalg
from s2sad.normalize.library.scipy_solvers import scipy_solvers
from s2sad.normalize.library.searchsorted import searchsorted
from s2sad.normalize.library.tuple_results import tuple_results
from s2sad.normalize.library.typed_rewrites import typed_rewrites
from s2sad.normalize.lists.growing import growing
from s2sad.normalize.lists.stack_growth import stack_growth
from s2sad.normalize.lists.list_allocation import list_allocation
from s2sad.normalize.lists.list_elements import coalesce_names, copies_in_tuples, unsupported_lists
from s2sad.normalize.lists.list_operators import list_operators
from s2sad.normalize.live_range_splitting import live_range_splitting
from s2sad.normalize.loops.guard_motion import guard_motion
from s2sad.normalize.loops.hoist_allocations import hoist_allocations
from s2sad.normalize.loops.scalarize import scalarize, scatter
from s2sad.normalize.single_assignment import single_assignment
from s2sad.normalize.type_table import declared_types, inferred_types, reported_types
from s2sad.normalize.views.coherence import coherence
from s2sad.normalize.views.contiguity import contiguity_guards, contiguous_arguments
from s2sad.normalize.views.view_aliases import unsupported_views
from s2sad.evaluate.scope import KernelScope
from s2sad.passes import Alternative, Context, Pass, Passes, Repeat, run
from s2sad.program import Kernel, Program
from s2sad.tree import FunctionDef, Name, walk


def in_loops(context: Context) -> bool:
    return context.in_loops


def in_arrays(context: Context) -> bool:
    return not context.in_loops


def shares_buffers(context: NormalContext) -> bool:
    return context.shared


STRUCTURE: Passes = (
    Pass(mgrid),
    Pass(positional_arguments),
    Pass(stack_growth),
    Pass(growing),
    Pass(single_target),
    Pass(definite_assignment),
    Pass(single_exit),
    Pass(counted_loops),
)
CALLS: Passes = (
    Pass(scipy_linalg),
    Pass(scipy_solvers),
    Pass(tuple_results),
    Pass(einsum),
    Pass(canonical_calls),
)
TYPES: Passes = (
    Pass(inline),
    Pass(tuple_arguments),
    Repeat((
        Pass(live_range_splitting),
        Pass(coalesce_names),
        Pass(requested_dtypes),
        Pass(copies_in_tuples),
        Pass(list_operators),
        Pass(einsum_ellipsis),
        Pass(weak_results, when=has_float32),
    ), again=2),
    Pass(reported_types),
    Pass(typed_rewrites),
    Pass(expression_depth),
    Pass(operand_types),
    Pass(complex_support),
    Pass(declared_types),
)
ARRAYS: Passes = (
    Alternative(
        passes=(
            Pass(overflow),
            Pass(argument_rotation),
            Pass(array_literals),
            Pass(list_allocation),
            Pass(conditional_values),
            Pass(batched_products),
            Pass(searchsorted),
            Pass(differentiable),
            Pass(array_anf),
            Pass(coherence),
            Pass(unsupported_views),
            Pass(contiguous_arguments),
            Pass(expand),
            Pass(resolve_views),
            Pass(bounds_check_elimination),
            Pass(guard_motion),
            Pass(unsupported_lists),
            Pass(contiguity_guards),
            Pass(hoist_allocations),
            Pass(callee_units, form="views"),
        ),
        verdict=shares_buffers,
        changes=(
            (Pass(array_privatization), Pass(swap_contents), Pass(tail_duplication)),
            (Pass(peel_shared_array),),
        ),
    ),
)
LOOPS: Passes = (
    Pass(lu, when=in_loops),
    Pass(hoist_allocations, "hoist_factors", when=in_loops),
    Pass(scalarize, when=in_loops, form="views"),
    Pass(scatter, when=in_arrays, form="views"),
)
NUMBERS: Passes = (
    Pass(single_assignment, form="rename"),
    Pass(inferred_types),
    Pass(callee_units, "callees_of_numbers"),
    Pass(anf, form="atoms"),
    Pass(check_known),
)
PASSES: Passes = (*STRUCTURE, *CALLS, *TYPES, *ARRAYS, *LOOPS, *NUMBERS)


def structured_form(kernel: Kernel, names: Names, program: Program, passes: Passes = STRUCTURE) -> FunctionDef:
    """A kernel in structured form, before types are known; new names come from `names`."""
    names.taken |= {node.id for node in walk(kernel.tree) if isinstance(node, Name)}
    return run(passes, kernel.tree, KernelScope(kernel=kernel, names=names, program=program))


def canonical_form(kernel: Kernel, names: Names, program: Program) -> FunctionDef:
    """A kernel in structured form, with functions of libraries under one spelling."""
    return structured_form(kernel, names, program, (*STRUCTURE, *CALLS))


__all__ = ["ARRAYS", "CALLS", "LOOPS", "NUMBERS", "PASSES", "STRUCTURE", "TYPES", "canonical_form", "structured_form"]
