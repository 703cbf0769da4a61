"""spelled: calls with several spellings take the one that has a rule.

    min(a, b, c)        min(min(a, b), c)
    math.log(x, b)      math.log(x) / math.log(b)
"""
from __future__ import annotations

from functools import reduce

from s2sad.tree import AST, BinOp, Call, Div, FunctionDef, at, call, call_name, copy, rebuild

_PAIRED = {"builtins.min", "builtins.max"}


def spelled(function: FunctionDef) -> FunctionDef:
    """The function with such calls in their plain spelling; the order of evaluation stays."""
    new = copy(function)
    new.body = [rebuild(statement, _plain) for statement in function.body]
    return new


def _plain(node: AST) -> AST | None:
    name = call_name(node)
    if not isinstance(node, Call) or node.keywords:
        return None
    args = [rebuild(a, _plain) for a in node.args]
    if name in _PAIRED and len(args) > 2:
        return at(reduce(lambda a, b: call(name, a, b), args), node)
    if name == "math.log" and len(args) == 2:
        return at(BinOp(call(name, args[0]), Div(), call(name, args[1])), node)
    return None
