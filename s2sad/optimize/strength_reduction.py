"""strength_reduction: cheaper operations over whole arrays, for NumPy.

Small integer powers, of which it takes logarithms, become squares and products,

    def f(x: float64[:], y: float64[:]):
        y[:] = x ** 5

in its tangent:

    def f_tangent(...):                         def f_tangent(...):
        ...                                         ...
        y_dot[...] = 5.0 * x ** 4 * x_dot           y_dot[...] = 5.0 * (x ** 2) ** 2 * x_dot
        y[...] = x ** 5                             y[...] = (x ** 2) ** 2 * x

and a shadow over a number that is not 0 is divided without a test of each element:

    def f(s: float64[:], dx, y: float64[:]):
        y[:] = s / dx

in its adjoint:

    def f_adjoint(...):
        ...
        s_bar[...] += np.where(y_bar != 0.0, y_bar / dx, 0.0)
        ...

becomes

    def f_adjoint(...):
        ...
        s_bar[...] += y_bar / dx if abs(dx) > 0.0 else np.where(y_bar != 0.0, y_bar / dx, 0.0)
        ...

*Requires* finished text for NumPy and the types of its names. *Establishes* the same values up to rounding: 0 / dx is 0
for every number but 0 and nan.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.infer.types import Type
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, BinOp, Compare, Constant, Div, FunctionDef, Gt, IfExp, Mult, Name, NotEq, Pow, Slice, Subscript, at, call,
    call_name, compare, const, copy, dump, indices, rebuild, with_body,
)

CHANGES_ROUNDING = True

_LARGEST_EXPONENT = 8


def strength_reduction(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such powers of names and of parts of arrays, and such quotients."""
    types = context.types

    def power(node: AST) -> AST | None:
        exponent = _exponent(node)
        if exponent is None or not isinstance(node, BinOp) or not _is_array(node.left, types):
            return None
        return at(_power_by_squaring(node.left, exponent), node)

    def division(node: AST) -> AST | None:
        quotient = _guarded_quotient(node)
        if quotient is None or not _is_float(quotient.right, types):
            return None
        test = compare(call("builtins.abs", copy(quotient.right)), Gt(), const(0.0))
        return at(IfExp(test, copy(quotient), copy(node)), node)
    return with_body(function, [rebuild(rebuild(s, power), division) for s in function.body])


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


def _guarded_quotient(node: AST) -> BinOp | None:
    """The quotient in `np.where(s != 0.0, s / d, 0.0)`."""
    if call_name(node) != "numpy.where" or dump(node.args[2]) != dump(const(0.0)):
        return None
    test, quotient = node.args[:2]
    found = isinstance(test, Compare) and isinstance(test.ops[0], NotEq) and dump(test.comparators[0]) == dump(
        const(0.0)) and isinstance(quotient, BinOp) and isinstance(quotient.op, Div)
    return quotient if found and dump(quotient.left) == dump(test.left) else None


def _is_float(node: AST, types: Mapping[str, Type]) -> bool:
    kind = types.get(node.id) if isinstance(node, Name) else None
    return kind is not None and kind.is_number and kind.is_float


__all__ = ["strength_reduction"]
