"""unguarded_division: a shadow over a nonzero scalar is divided without a test of each element, for NumPy.

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

*Requires* finished text for NumPy and the types of its names. *Establishes* the same values: 0 / dx is 0 for every
number but 0 and nan.
"""
from __future__ import annotations


from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, BinOp, Compare, Div, FunctionDef, Gt, IfExp, Name, NotEq, at, call, call_name, compare, const, copy, dump,
    rebuild, with_body,
)

CHANGES_ROUNDING = False


def unguarded_division(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function with such quotients."""
    types = context.types
    def change(node: AST) -> AST | None:
        quotient = _guarded_quotient(node)
        if quotient is None or not isinstance(divisor := quotient.right, Name):
            return None
        kind = types.get(divisor.id)
        if kind is None or not kind.is_number or not kind.is_float:
            return None
        test = compare(call("builtins.abs", copy(divisor)), Gt(), const(0.0))
        return at(IfExp(test, copy(quotient), copy(node)), node)
    return with_body(function, [rebuild(s, change) for s in function.body])


def _guarded_quotient(node: AST) -> BinOp | None:
    """The quotient in `np.where(s != 0.0, s / d, 0.0)`."""
    if call_name(node) != "numpy.where" or dump(node.args[2]) != dump(const(0.0)):
        return None
    test, quotient = node.args[:2]
    found = isinstance(test, Compare) and isinstance(test.ops[0], NotEq) and dump(test.comparators[0]) == dump(
        const(0.0)) and isinstance(quotient, BinOp) and isinstance(quotient.op, Div)
    return quotient if found and dump(quotient.left) == dump(test.left) else None


__all__ = ["unguarded_division"]
