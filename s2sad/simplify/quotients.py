"""quotients: a quotient of complex numbers becomes a call, for Numba, whose operator raises where NumPy's gives inf.

Requires types; changes nothing where nothing is complex.

    h = 1.0 / z         h = np.divide(1.0, z)
"""
from __future__ import annotations

from s2sad.infer.infer import Typing, learn
from s2sad.rules.rule import number
from s2sad.tree import AST, BinOp, Div, FunctionDef, at, call, rebuild, with_body


def quotients(function: FunctionDef, typing: Typing) -> FunctionDef:
    """The function with such calls."""
    def change(node: AST) -> AST | None:
        if not isinstance(node, BinOp) or not isinstance(node.op, Div) or number(node.right) or not typing.of(
                node).is_complex:
            return None
        made = call("numpy.divide", rebuild(node.left, change), rebuild(node.right, change))
        return at(made, node) if getattr(node, "lineno", None) else made
    if not any(t.is_complex for t in typing.table.values()):
        return function
    typing = Typing(dict(typing.table), lambda kernel, types: (), typing.report, typing.constants)
    learn(function.body, typing)    # names that passes have made since
    return with_body(function, [rebuild(s, change) for s in function.body])
