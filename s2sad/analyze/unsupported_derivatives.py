"""unsupported_derivatives: refuses calls that need of a derivative of the user's own what it does not give.

Requires activity; establishes that every active call of a function with its own derivative has the roles in it that
the call needs. Changes nothing.
"""
from __future__ import annotations

from s2sad.analyze.callee_derivatives import is_kernel_call, activity_pattern
from s2sad.analyze.context import AnalysisContext
from s2sad.tree import Assign, AugAssign, Expr, FunctionDef, walk_statements


def unsupported_derivatives(function: FunctionDef, context: AnalysisContext) -> None:
    """Reports each such call."""
    for statement in walk_statements(function.body):
        if isinstance(statement, (Assign, AugAssign, Expr)) and is_kernel_call(statement):
            pattern = activity_pattern(statement, context.typing, context.activity.active)
            wrong = context.calls.unsupported(statement.value, pattern, context.mode)
            if wrong:
                context.report.error("S301", wrong, statement,
                                     help="give it with s2sad.rule, whose docstring says what it takes and returns")
