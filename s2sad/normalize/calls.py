"""Calls of the user's functions: arguments bound to positions, and how many results a function returns."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from s2sad.normalize.memory import bindings
from s2sad.normalize.scope import Scope
from s2sad.program import Kernel, Program
from s2sad.tree import AST, Call, Constant, IfExp, Name, Return, Tuple, call_name, const, name, negate, walk


def user_call(node: AST) -> str | None:
    """The kernel that a call calls, or None if the node is no call of one."""
    called = call_name(node)
    return called[len("user."):] if called is not None and called.startswith("user.") else None


def bound_arguments(node: Call, scope: Scope) -> list[AST]:
    """The arguments by position, defaults filled in; what does not fit is reported."""
    called = user_call(node)
    kernel = scope.program.kernels.get(called or "")
    if kernel is None:
        scope.refuse(node, f"{called} is not a function that was read", code="S202")
        return node.args
    wanted = ", ".join(kernel.parameters)
    given: dict[str | None, AST] = dict(zip(kernel.parameters, node.args))
    if len(node.args) > len(kernel.parameters):
        scope.refuse(node, f"{called}({wanted}) is given {len(node.args)} arguments", code="S405")
    for keyword in node.keywords:
        if keyword.arg not in kernel.parameters or keyword.arg in given:
            why = "twice" if keyword.arg in given else "which it does not have"
            scope.refuse(node, f"{called}({wanted}) is given the parameter {keyword.arg!r} {why}", code="S405")
        given[keyword.arg] = keyword.value
    for parameter in kernel.parameters:
        if parameter not in given and parameter not in kernel.defaults:
            scope.refuse(node, f"{called}({wanted}) is called without {parameter!r}", code="S405")
    return [given[p] if p in given else _default(kernel, p, node, scope) for p in kernel.parameters]


def _default(kernel: Kernel, parameter: str, node: Call, scope: Scope) -> AST:
    written = _literal(kernel.defaults.get(parameter))
    if written is None:
        scope.refuse(node, f"the default of {parameter!r} of {kernel.name} is no number",
                     help=f"give {parameter!r} at the call", code="S405")
        return Constant(None, None)
    return written


def _literal(value: Any) -> AST | None:
    """A Python value as an expression, or None if it has no spelling."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        spelled = name("numpy.nan" if math.isnan(value) else "numpy.inf")
        return negate(spelled) if value < 0 else spelled
    if value is None or isinstance(value, (bool, int, float, str)):
        return const(value)
    if isinstance(value, tuple):
        items = [_literal(item) for item in value]
        return None if any(item is None for item in items) else Tuple(items, name("x").ctx)
    return None


def result_count(kernel: str, program: Program, seen: tuple[str, ...] = ()) -> int:
    """How many values a kernel returns as a tuple; 1 if it returns anything else, or nothing."""
    given = program.kernels.get(kernel)
    if given is None or kernel in seen:
        return 1
    counts = [_count(node.value, given, program, (*seen, kernel))
              for node in walk(given.tree.body) if isinstance(node, Return) and node.value is not None]
    return max(counts, default=1)


def _count(value: AST, kernel: Kernel, program: Program, seen: tuple[str, ...]) -> int:
    if isinstance(value, Tuple):
        return len(value.elts)
    if isinstance(value, IfExp):
        return _count(value.body, kernel, program, seen)
    called = user_call(value)
    if called is not None:
        return result_count(called, program, seen)
    if isinstance(value, Name):
        bound = [v for target, v in bindings(kernel.tree) if isinstance(target, Name) and target.id == value.id
                 and (isinstance(v, Tuple) or user_call(v) is not None)]
        return max((_count(v, kernel, program, seen) for v in bound), default=1)
    return 1
