"""spelled: calls with several spellings take the one that has a rule.

    min(a, b, c)        min(min(a, b), c)
    math.log(x, b)      math.log(x) / math.log(b)
    math.prod((a, b))   a * b

and, once types are known, subscripts the one that views are made of:

    x[i, :]             x[i]
"""
from __future__ import annotations

from functools import reduce

from s2sad.diagnostics import Report
from s2sad.infer.infer import Typing
from s2sad.tree import (
    AST, BinOp, Call, Constant, Div, FunctionDef, List, Slice, Starred, Subscript, Tuple, at, call, call_name, const,
    copy, index, indices, mult, rebuild,
)

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
    if name == "math.prod" and len(args) == 1 and isinstance(args[0], (Tuple, List)):
        items = args[0].elts
        if not any(isinstance(item, Starred) for item in items):
            return at(reduce(mult, items if len(items) > 1 else [const(1), *items]), node)
    return None


def rows(function: FunctionDef, typing: Typing, report: Report) -> FunctionDef:
    """The function without whole axes at the end of its subscripts; each must be an axis of the array."""
    def change(node: AST) -> AST | None:
        if not isinstance(node, Subscript) or not _ends_whole(indices(node)):
            return None
        parts, base = indices(node), typing.of(node.value)
        if base.is_array and len(parts) > base.rank:
            report.error("S203", f"{len(parts)} subscripts for {base}", node,
                         help="the types are taken from the arguments: check their ranks")
        while _ends_whole(parts):
            parts = parts[:-1]
        new = index(rebuild(node.value, change), *(rebuild(p, change) for p in parts))
        return at(Subscript(new.value, new.slice, node.ctx), node)

    new = copy(function)
    new.body = rebuild(function.body, change)
    return new


def _ends_whole(parts: list[AST]) -> bool:
    """Whether the last of several subscripts is a whole axis."""
    last = parts[-1]
    others = not any(isinstance(p, Constant) and p.value is ... for p in parts)
    return len(parts) > 1 and others and isinstance(last, Slice) and last.lower is last.upper is last.step is None
