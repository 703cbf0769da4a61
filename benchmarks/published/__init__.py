"""Fifty published kernels, written as their authors write them: s2sad beside the primal and beside JAX.

    linear_algebra, stencils, learning, physics    the kernels
    cases       their arguments, inputs and outputs, and why JAX has no version where it has none
    in_jax      the same kernels as JAX users write them
    measure     times and errors of one kernel; worker: of several, in a process that may be killed
    section     the chapter of docs/performance.md
"""
