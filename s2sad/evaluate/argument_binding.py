"""Calls: arguments bound to positions and parameters, and how many results a function returns."""
from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import cache

from s2sad.evaluate.scope import KernelScope
from s2sad.program import Kernel, Program
from s2sad.read.outside_values import library_value
from s2sad.tree import AST, Call, Constant, IfExp, Return, Tuple, literal, user_call, walk_statements

AXES = frozenset(("axis", "axis1", "axis2", "axes", "source", "destination"))
OPTIONS = AXES | {"keepdims", "ord", "norm", "mode", "pad_width", "reps", "side", "indexing"}     # of NumPy's functions


def bound_arguments(node: Call, scope: KernelScope) -> list[AST]:
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


def _default(kernel: Kernel, parameter: str, node: Call, scope: KernelScope) -> AST:
    written = literal(kernel.defaults.get(parameter))
    if written is None:
        scope.refuse(node, f"the default of {parameter!r} of {kernel.name} is no number",
                     help=f"give {parameter!r} at the call", code="S405")
        return Constant(None, None)
    return written


def result_count(kernel: str, program: Program) -> int:
    """How many values a kernel returns side by side, 0 if it returns nothing; of tuples of several lengths the
    longest."""
    return program.once(_counts).get(kernel, 1)


def _counts(program: Program) -> dict[str, int]:
    """How many values every kernel returns, callees first."""
    found: dict[str, int] = {}
    for title, kernel in program.kernels.items():
        found[title] = max((_count(s.value, found) for s in walk_statements(kernel.tree.body) if isinstance(
            s, Return) and s.value is not None), default=0)
    return found


def _count(value: AST, found: Mapping[str, int]) -> int:
    if isinstance(value, Tuple):
        return len(value.elts)
    if isinstance(value, IfExp):
        return max(_count(value.body, found), _count(value.orelse, found))
    return found.get(user_call(value) or "", 1)


@cache
def parameters_of_library(path: str) -> tuple[str, ...]:
    """The parameters of a function of NumPy's that arguments by place stand for."""
    if not path.startswith("numpy."):
        return ()
    try:
        found = inspect.signature(library_value(path)).parameters.values()
    except (TypeError, ValueError):
        return ()
    return tuple(p.name for p in found if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD))
