"""primal_contraction: array contraction in a kernel, before it is differentiated.

    def f(u, v, n):                     def f(u, v, n):
        w = np.empty(n)                     w = np.empty(n)
        for i in range(n):                  for i in range(n):
            w[i] = 2.0 * u[i] + v[i]            w_here = 2.0 * u[i] + v[i]
        for i in range(n):                      v[i] += w_here * w_here
            v[i] += w[i] * w[i]

*Requires* the loops of a kernel for Numba. *Establishes* the same values, with scalars for arrays that one nest
produces for the next alone. A scalar is recomputed where its operands are intact; the array would be recorded, and its
shadow filled and cleared. Nests without such an array are not fused here, since derivatives of many arrays in one loop
do not vectorize; `loop_fusion` fuses them afterwards.
"""
from __future__ import annotations

from s2sad.infer.types import FLOAT
from s2sad.normalize.context import NormalContext
from s2sad.optimize.iteration_spaces import IterationSpaces
from s2sad.optimize.loop_fusion import LoopFusion
from s2sad.optimize.array_contraction import Contractible
from s2sad.tree import Call, FunctionDef, call_name, walk, with_body

CHANGES_ROUNDING = True     # a derivative adds what a number gains in another order than what elements gain


def primal_contraction(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function; the context has for every new number the array whose element it is."""
    writing = {call_name(n) or "" for n in walk(function.body)
               if isinstance(n, Call) and context.callees.call_writes(n)}
    extents = IterationSpaces(function, writing)
    between = Contractible(function, extents, context.typing.table, context.names)
    new = with_body(function, LoopFusion(extents, set(), between, only_producers=True).block(function.body))
    context.numbers = between.numbers
    for number in between.numbers:
        context.typing.declare(number, FLOAT)
    return new


__all__ = ["primal_contraction"]
