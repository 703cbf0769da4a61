"""powers: small integer powers of arrays as squares and products, for NumPy, which takes a logarithm for them.

    mean_bar += 5.0 * mean ** 4 * g         mean_bar += 5.0 * (mean ** 2) ** 2 * g
    p = mean ** 5                           p = (mean ** 2) ** 2 * mean

Requires finished text for NumPy and the types of its names; establishes the same values up to rounding.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.types import Type
from s2sad.tree import (
    AST, BinOp, Constant, FunctionDef, Mult, Name, Pow, Slice, Subscript, at, const, copy, indices, rebuild,
    with_body,
)

CHANGES_ROUNDING = True

_MOST = 8


def powers(function: FunctionDef, types: Mapping[str, Type]) -> FunctionDef:
    """The function with such powers of names and of parts of arrays."""
    def change(node: AST) -> AST | None:
        exponent = _exponent(node)
        if exponent is None or not isinstance(node, BinOp) or not _is_array(node.left, types):
            return None
        return at(_product(node.left, exponent), node)
    return with_body(function, [rebuild(s, change) for s in function.body])


def _exponent(node: AST) -> int | None:
    known = isinstance(node, BinOp) and isinstance(node.op, Pow) and isinstance(node.right, Constant) and type(
        node.right.value) is int
    return node.right.value if known and 2 < node.right.value <= _MOST else None


def _is_array(node: AST, types: Mapping[str, Type]) -> bool:
    base = node.value if isinstance(node, Subscript) else node
    kind = types.get(base.id) if isinstance(base, Name) else None
    if kind is None or not kind.is_array or not kind.is_float:
        return False
    return node is base or any(isinstance(s, Slice) for s in indices(node))


def _product(base: AST, exponent: int) -> AST:
    if exponent == 1:
        return copy(base)
    if exponent == 2:
        return BinOp(copy(base), Pow(), const(2))
    if exponent % 2:
        return BinOp(_product(base, exponent - 1), Mult(), copy(base))
    return BinOp(_product(base, exponent // 2), Pow(), const(2))


__all__ = ["powers"]
