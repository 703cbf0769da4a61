"""iterated: Python's own sum, max and min of an array are NumPy's.

    sum(x)              np.sum(x)
    sum(x, c)           c + np.sum(x)
    sum(m)              np.sum(m, axis=0)
    max(x)              np.max(x)

Requires types.
"""
from __future__ import annotations

from s2sad.infer.infer import Typing
from s2sad.tree import AST, Add, BinOp, Call, FunctionDef, at, call, call_name, const, copy, rebuild


def iterated(function: FunctionDef, typing: Typing) -> FunctionDef:
    """The function with those calls."""
    def change(node: AST) -> AST | None:
        word = (call_name(node) or "").removeprefix("builtins.")
        if not isinstance(node, Call) or word not in ("sum", "max", "min") or node.keywords or not node.args:
            return None
        rank, others = typing.of(node.args[0]).rank, node.args[1:]
        if not rank or others and word != "sum" or rank > 1 and word != "sum":
            return None
        inner = rebuild(node.args[0], change)
        made = call(f"numpy.{word}", inner, axis=const(0)) if rank > 1 else call(f"numpy.{word}", inner)
        return at(BinOp(rebuild(others[0], change), Add(), made) if others else made, node)

    new = copy(function)
    new.body = [rebuild(statement, change) for statement in function.body]
    return new
