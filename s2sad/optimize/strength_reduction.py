"""strength_reduction: small integer powers of arrays become squares and products, for NumPy, which takes logarithms.

    def f(x: float64[:], y: float64[:]):
        y[:] = x ** 5

in its tangent:

    def f_tangent(...):                         def f_tangent(...):
        ...                                         ...
        y_dot[...] = 5.0 * x ** 4 * x_dot           y_dot[...] = 5.0 * (x ** 2) ** 2 * x_dot
        y[...] = x ** 5                             y[...] = (x ** 2) ** 2 * x

*Requires* finished text for NumPy and the types of its names. *Establishes* the same values up to rounding.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.types import Type
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, BinOp, Constant, FunctionDef, Mult, Name, Pow, Slice, Subscript, at, const, copy, indices, rebuild,
    with_body,
)

CHANGES_ROUNDING = True

_LARGEST_EXPONENT = 8


def strength_reduction(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such powers of names and of parts of arrays."""
    types = context.types
    def change(node: AST) -> AST | None:
        exponent = _exponent(node)
        if exponent is None or not isinstance(node, BinOp) or not _is_array(node.left, types):
            return None
        return at(_power_by_squaring(node.left, exponent), node)
    return with_body(function, [rebuild(s, change) for s in function.body])


def _exponent(node: AST) -> int | None:
    known = isinstance(node, BinOp) and isinstance(node.op, Pow) and isinstance(node.right, Constant) and type(
        node.right.value) is int
    return node.right.value if known and 2 < node.right.value <= _LARGEST_EXPONENT else None


def _is_array(node: AST, types: Mapping[str, Type]) -> bool:
    base = node.value if isinstance(node, Subscript) else node
    kind = types.get(base.id) if isinstance(base, Name) else None
    if kind is None or not kind.is_array or not kind.is_float:
        return False
    return node is base or any(isinstance(s, Slice) for s in indices(node))


def _power_by_squaring(base: AST, exponent: int) -> AST:
    if exponent == 1:
        return copy(base)
    if exponent == 2:
        return BinOp(copy(base), Pow(), const(2))
    if exponent % 2:
        return BinOp(_power_by_squaring(base, exponent - 1), Mult(), copy(base))
    return BinOp(_power_by_squaring(base, exponent // 2), Pow(), const(2))


__all__ = ["strength_reduction"]
