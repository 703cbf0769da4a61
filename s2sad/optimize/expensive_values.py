"""expensive_values: the transcendental calls that are worth a load from memory, and what statements do to their
operands."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Set

from s2sad.infer.types import Type
from s2sad.liveness import base_name
from s2sad.optimize.loop_bounds import bound_names, stored_elements
from s2sad.tree import AST, Constant, Expr, Name, call_name, names, walk

_EXPENSIVE = {f"{room}.{f}" for room in ("numpy", "math") for f in (
    "exp", "expm1", "exp2", "log", "log1p", "log2", "log10", "sinh", "cosh", "tanh", "sin", "cos", "tan")}


def is_expensive(node: AST) -> bool:
    """Whether a node is such a call."""
    return call_name(node) in _EXPENSIVE


def is_double(argument: AST, types: Mapping[str, Type], counters: Iterable[str]) -> bool:
    """Whether a value is a float64 number for certain: a complex argument gives none."""
    known = {n for n, kind in types.items() if kind.dtype in ("float64", "int64")} | {*counters}
    library = ("numpy.", "math.", "builtins.")
    words = {n.id for n in walk(argument) if isinstance(n, Name) and not n.id.startswith(library)}
    return words <= known and not any(
        isinstance(n, Constant) and isinstance(n.value, complex) for n in walk(argument))


def changed_names(statement: AST, writing: Set[str]) -> set[str]:
    """What a statement may bind or write; `writing` are the functions that write arrays."""
    calls = [n for n in walk(statement) if isinstance(n, Expr) or call_name(n) in writing]
    return bound_names([statement]) | {base_name(t) for t in stored_elements([statement])} | set(names(calls))
