"""handed: arrays that one nest of loops only hands to the next are numbers.

    for i in range(n):                      for i in range(n):
        w[i] = a * u[i] + v[i]                  w_here = a * u[i] + v[i]
    for i in range(n):                          v[i] += w_here * w_here
        v[i] += w[i] * w[i]

Requires the loops of a kernel for Numba, before it is differentiated; establishes the same values. A number is
computed again where its operands are intact; the array would be recorded, and its shadow filled and emptied. Nests that
hand on no array stay apart: derivatives of many arrays in one loop do not run in vectors, and `joined` sees to them.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.extents import Extents
from s2sad.simplify.joined import Joining
from s2sad.simplify.passed import Passed
from s2sad.tree import FunctionDef, copy

CHANGES_ROUNDING = True     # a derivative adds what a number gains in another order than what elements gain


def handed(function: FunctionDef, types: Mapping[str, Type], free: Names,
           writing: Set[str]) -> tuple[FunctionDef, dict[str, str]]:
    """The function, and for every new number the array whose element it is; `writing` are the functions that write
    arrays."""
    new = copy(function)
    extents = Extents(function, writing)
    between = Passed(function, extents, types, free)
    new.body = Joining(extents, set(), between, handing=True).block(function.body)
    return new, between.numbers


__all__ = ["handed"]
