"""independents: the parameters that a gradient is with respect to by default, whatever the arguments of a call are.

Requires fenced trees with resolved names, callees before callers. In this order: the annotation; the default value;
use: an array holds floats unless its elements are bounds, indices or shifts, a number is a float unless it is one of
these or only chooses.

    def f(u, n, c, scheme, order=3, t: float = 0):          u, c, t
        for i in range(n):
            u[i] *= c ** order if scheme == 2 else 1.0

The value of `c or 1.0` is c: it only chooses where nothing but its truth is read.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from s2sad.infer.assumed_types import parsed_type, uses_of
from s2sad.tree import (
    AST, Assert, Assign, BoolOp, Call, Compare, Constant, FunctionDef, If, IfExp, Load, Lt, LtE, Gt, GtE, Name, Not,
    UnaryOp, While, call_name, walk,
)

_NO_FLOATS = ("str", "bool")
_ORDERS = (Lt, LtE, Gt, GtE)


def independents(usable: frozenset[str], parameters: tuple[str, ...], annotations: Mapping[str, str],
                 defaults: Mapping[str, Any]) -> tuple[str, ...]:
    """The parameters that are floats by annotation, default or use."""
    return tuple(p for p in parameters if _is_float(p in usable, annotations.get(p, ""), defaults.get(p, 0.0)))


def usable_as_floats(entry: str, trees: Mapping[str, FunctionDef]) -> frozenset[str]:
    """The parameters of the entry that may be floats by use."""
    uses, choosing = uses_of(trees), {}
    for title, tree in trees.items():
        choosing[title] = _only_choosing(tree, choosing, trees)
    parameters = {a.id for a in trees[entry].args.args}
    return frozenset(parameters - set(uses[entry].integers) - choosing[entry])


def _is_float(by_use: bool, annotation: str, default: Any) -> bool:
    kind = parsed_type(annotation)
    if kind is not None or annotation.strip("\"'") in _NO_FLOATS:
        return kind is not None and kind.is_inexact
    if isinstance(default, (bool, int, str, np.integer, np.bool_)):
        return False
    return by_use


def _only_choosing(tree: FunctionDef, others: Mapping[str, set[str]], trees: Mapping[str, FunctionDef]) -> set[str]:
    """The names of a function that are read, and only to be compared with what is no float, or for their truth."""
    read = Counter(n.id for n in walk(tree.body) if isinstance(n, Name) and isinstance(n.ctx, Load))
    choosing: set[str] = set()
    while True:     # what is bound to a name that only chooses does as well
        chosen = Counter(c.id for node in walk(tree.body) for c in _choosing_operands(node, others, trees, choosing)
                         if isinstance(c, Name))
        more = {n for n in read if read[n] == chosen[n]} - choosing
        if not more:
            return choosing
        choosing |= more


def _truth_operands(node: AST) -> Iterator[AST]:
    """The operands of which an expression's truth is made; the value of `a or b` itself is one of them."""
    if isinstance(node, BoolOp):
        for operand in node.values:
            yield from _truth_operands(operand)
    else:
        yield node


def _choosing_operands(node: AST, others: Mapping[str, set[str]], trees: Mapping[str, FunctionDef], choosing: set[str]
             ) -> Iterator[AST]:
    """The operands of a node that only choose."""
    if isinstance(node, (If, IfExp, While, Assert)):
        yield from _truth_operands(node.test)
    elif isinstance(node, UnaryOp) and isinstance(node.op, Not):
        yield from _truth_operands(node.operand)
    elif isinstance(node, Assign):
        if all(isinstance(t, Name) and t.id in choosing for t in node.targets):
            yield from _truth_operands(node.value)
    elif isinstance(node, Compare):
        operands = [node.left, *node.comparators]
        if not any(isinstance(op, _ORDERS) for op in node.ops) and any(
                isinstance(o, Constant) and not isinstance(o.value, (float, complex)) for o in operands):
            yield from operands
    elif isinstance(node, Call):
        helper = (call_name(node) or "").removeprefix("user.")
        if helper in others:
            passed = [*zip((a.id for a in trees[helper].args.args), node.args),
                     *((k.arg, k.value) for k in node.keywords)]
            yield from (n for parameter, argument in passed if parameter in others[helper]
                        for n in _truth_operands(argument))
