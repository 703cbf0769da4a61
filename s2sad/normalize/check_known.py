"""check_known: every operation gives a number or an array; what has another type, or none, would pass as constant.

    def f(x: "float64[:]"):
        return x[0] * max(x.shape + x.shape)

refused: the type of this cannot be inferred

Requires normal form and types; changes nothing.
"""
from __future__ import annotations

from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    Assign, AugAssign, BinOp, Call, FunctionDef, IfExp, Return, Subscript, UnaryOp, user_call, walk, walk_statements,
)

_WRONG = {Call: ("unknown", "tuple"), BinOp: ("unknown",), UnaryOp: ("unknown", "tuple"), IfExp: ("unknown", "tuple"),
          Subscript: ("unknown",)}      # x.shape + (2,) and x.shape[1:] are shapes


def check_known(function: FunctionDef, context: NormalContext) -> None:
    """Refuses operations of any other type; calls of kernels may return several values."""
    typing, report = context.typing, context.report
    for statement in walk_statements(function.body):
        if not isinstance(statement, (Assign, AugAssign, Return)) or statement.value is None:
            continue
        for node in walk(statement.value):
            if typing.of(node).kind in _WRONG.get(type(node), ()) and not user_call(node):
                report.error("S203", "the type of this cannot be inferred", node,
                             help="write it with operations on numbers and arrays, each of which has a name")
                break
