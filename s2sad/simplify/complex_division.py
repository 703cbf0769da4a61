"""complex_division: a division of complex numbers becomes a call of `np.divide`, for Numba.

    def f(z: complex128[:], y: complex128[:]):
        for i in range(z.size):
            y[i] = 1.0 / z[i]

in its tangent:

    def f_tangent(...):             def f_tangent(...):
        for i in range(z.size):         for i in range(z.size):
            ratio = 1.0 / z[i]              ratio = np.divide(1.0, z[i])
            ...                             ...

*Requires* types; nothing changes where nothing is complex. *Establishes* that no complex division raises: Numba's
operator does, where NumPy's function gives inf.
"""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.passes import Context
from s2sad.rules.rule import number
from s2sad.tree import AST, BinOp, Div, FunctionDef, at, call, rebuild, with_body


def complex_division(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with such calls."""
    typing = context.typing
    def change(node: AST) -> AST | None:
        if not isinstance(node, BinOp) or not isinstance(node.op, Div) or number(node.right) or not typing.of(
                node).is_complex:
            return None
        made = call("numpy.divide", rebuild(node.left, change), rebuild(node.right, change))
        return at(made, node) if getattr(node, "lineno", None) else made
    if not any(t.is_complex for t in typing.table.values()):
        return function
    plain = Typing(typing.table, lambda kernel, types: (), typing.report, typing.constants)
    typing = plain.extended(function.body)      # by the names that passes have made since
    return with_body(function, [rebuild(s, change) for s in function.body])
