"""Calls of the user's functions: arguments bound to positions, and how many results a function returns."""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.evaluate.effects import bindings
from s2sad.evaluate.scope import KernelScope
from s2sad.program import Kernel, Program, Structure, leaves
from s2sad.tree import AST, Call, Constant, IfExp, List, Name, Return, Tuple, literal, user_call, walk_statements


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


def result_structure(kernel: str, program: Program) -> Structure:
    """What a kernel returns: a tuple of structures, for a list that is spelled out, too, or None for a single value; of
    tuples of several lengths the longest."""
    return program.once(_structures).get(kernel)


def _structures(program: Program) -> dict[str, Structure]:
    """What every kernel returns, callees first."""
    found: dict[str, Structure] = {}
    for title, kernel in program.kernels.items():
        each = [_structure(node.value, kernel, found)
                for node in walk_statements(kernel.tree.body) if isinstance(node, Return) and node.value is not None]
        found[title] = max((f for f in each if f is not None), key=len, default=None)
    return found


def result_count(kernel: str, program: Program) -> int:
    """How many values a kernel returns, those of tuples within tuples too; 1 if it returns nothing."""
    return len(leaves(result_structure(kernel, program)))


def _structure(value: AST, kernel: Kernel, found: Mapping[str, Structure]) -> Structure:
    if isinstance(value, (Tuple, List)):
        return tuple(_structure(e, kernel, found) if isinstance(e, (Tuple, List)) else None for e in value.elts)
    if isinstance(value, IfExp):
        return _structure(value.body, kernel, found)
    called = user_call(value)
    if called is not None:
        return found.get(called)
    if isinstance(value, Name):
        bound = [v for target, v in bindings(kernel.tree) if isinstance(target, Name) and target.id == value.id
                 and (isinstance(v, Tuple) or user_call(v) is not None)]
        each = [_structure(v, kernel, found) for v in bound]
        return max((f for f in each if f is not None), key=len, default=None)
    return None
