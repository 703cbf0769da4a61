"""unsupported_lists: a list or a part of one that stands inside an expression, where no pass has given it a name, is
refused.

    s = x[0] * (ks == [1, 2])           S201
    v = ((x[0], x[1])[::-1])[0]         S201

Requires views; changes nothing. What `form` would call no normal form is said here at the user's line.
"""
from __future__ import annotations

from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Expr, For, FunctionDef, If, List, Name, Return, Subscript, Tuple, While, walk,
)

_HELP = "give it a name in a statement of its own, or make it an array: np.array([...])"


def unsupported_lists(function: FunctionDef, context: NormalContext) -> None:
    """Reports them."""
    report = context.report
    for statement in walk(function.body):
        value = _value(statement)
        if value is None:
            continue
        wrong = next((n for n in walk(value) if isinstance(n, List) or isinstance(n, Subscript) and not isinstance(
            n.value, (Name, Attribute, Tuple))), None)
        if wrong is not None:
            place = wrong if getattr(wrong, "lineno", None) else statement
            what = "a list inside an expression" if isinstance(wrong, List) else "a part of what an expression gives"
            report.error("S201", f"{what} is not supported here", place, help=_HELP)


def _value(statement: AST) -> AST | None:
    if isinstance(statement, (Assign, AugAssign, Expr, Return)):
        return statement.value
    return statement.test if isinstance(statement, (If, While)) else statement.iter if isinstance(
        statement, For) else None
