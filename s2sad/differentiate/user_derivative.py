"""user_derivative: a derivative of the user's own for one call, with all that its callers must know.

Requires the function, its residual if it is implicit, and the request of the call; establishes the function that is
called, those beside it, and what they read and write.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from s2sad.analyze.request import DerivativeRequest
from s2sad.differentiate.derivative import Derivative
from s2sad.analyze.callee_derivatives import CalleeDerivative
from s2sad.differentiate.implicit import Implicit, Residual
from s2sad.differentiate.user_functions import UserFunction, user_adjoint, user_forward, user_tangent
from s2sad.infer.types import UNKNOWN, Type
from s2sad.tree import FunctionDef


@dataclass(frozen=True)
class CompleteDerivative:
    """One derivative: the function with its table, functions `beside` it, the types of its names, what a caller must
    know, and the positions of arrays, of those that it reads and that it writes."""
    made: Derivative
    beside: tuple[FunctionDef, ...]
    types: dict[str, Type]
    callee: CalleeDerivative
    arrays: frozenset[int]
    reads: frozenset[int]
    writes: frozenset[int]


def user_derivative(owner: UserFunction, residual: Residual | None, mode: str, request: DerivativeRequest, title: str,
                    forward: str,
          fresh: Callable[[str], str]) -> CompleteDerivative:
    """The derivative; `forward` is the name of the first half of the adjoint, where it is made already, and `fresh`
    makes names for the file."""
    reverse = mode == "adjoint"
    pair = reverse and "forward" in owner.own.functions
    beside: tuple[FunctionDef, ...] = ()
    if residual is not None:
        product = fresh(f"{owner.title}_{'transposed' if reverse else 'linear'}")
        implicit = Implicit(owner, residual, request, title, "bar" if reverse else "dot", product)
        made, beside = implicit.adjoint() if reverse else implicit.tangent()
    else:
        made = user_adjoint(owner, request, title) if reverse else user_tangent(owner, request, title)
    if pair and not forward:
        forward = fresh(f"{owner.title}_forward")
        beside = (user_forward(owner, forward),)
    read, written = touched(owner, residual, mode)
    types = {**owner.types, **{s: owner.types[p] for p, s in made.shadows.items()}}
    for parameter, _, primal in made.parameters:
        types.setdefault(parameter, owner.results[int(primal.split()[1])] if primal.startswith("return ") else UNKNOWN)
    names = [n for n, _, _ in made.parameters]
    shadows = {made.shadows[p]: p for p in made.shadows if made.shadows[p] in names}
    arrays = [k for k, n in enumerate(names) if types[n].is_array]
    order = list(owner.types)
    callee = CalleeDerivative(
        f"user.{title}", tuple(order.index(p) for p in shadows.values()),
        tuple(int(o.split()[1]) for o in request.of if o.startswith("return ")),
        tuple(order.index(p) for p in request.wrt if p in owner.numbers),
        tuple(k for k, p in enumerate(order) if p in read), tuple(k for k, p in enumerate(order) if p in written),
        f"user.{forward}" if pair else "", len(owner.results), residual is not None,
        tuple(int(p.split()[1]) for _, role, p in made.parameters if role == "value"), True)
    return CompleteDerivative(made, beside, types, callee, frozenset(arrays),
                              frozenset(k for k in arrays if names[k] in shadows or names[k] in read),
                              frozenset(k for k in arrays if names[k] in shadows or names[k] in written))


def touched(owner: UserFunction, residual: Residual | None, mode: str) -> tuple[frozenset[str], frozenset[str]]:
    """The arrays of the function whose content a derivative reads, and those that it overwrites."""
    if mode == "tangent":
        return owner.reads(mode) if residual is None else frozenset(owner.types), owner.written
    if residual is not None:
        return frozenset(owner.types) & frozenset(residual.parameters), frozenset()
    return owner.reads(mode), owner.written & owner.reads(mode)
