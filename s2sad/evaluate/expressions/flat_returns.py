"""flat_returns: every return of tuples within tuples returns their values in a row.

    def f(x, y):                        def f(x, y):
        a = np.sin(x)                       a = np.sin(x)
        return [a, np.cos(y)], x * y        return a, np.cos(y), x * y

*Requires* a tree in the supported subset with resolved names. *Establishes* that what is returned is one value, or a
tuple of values; a list that is spelled out there is a tuple. `argument_binding.result_structure` tells the rest.
"""
from __future__ import annotations

from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, FunctionDef, IfExp, List, Return, Tuple, at, const, copy, dump, rebuild, tuple_of, walk_statements,
)


def flat_returns(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function with such returns; a list that is spelled out there is a tuple."""
    tree = copy(function)
    for node in walk_statements(tree.body):
        if isinstance(node, Return) and node.value is not None:
            node.value = _as_tuples(node.value)
    returns = [n for n in walk_statements(tree.body) if isinstance(n, Return) and isinstance(n.value, Tuple)]
    shapes = [dump(rebuild(n.value, lambda v: None if isinstance(v, Tuple) else const(0))) for n in returns]
    for node, shape in zip(returns, shapes):
        if any(isinstance(item, Tuple) for item in node.value.elts):
            if shape != shapes[0]:
                scope.refuse(node, "returns of tuples of different structure", help="return the same on every path")
            node.value = at(tuple_of(*_items(node.value)), node.value)
    return tree


def _as_tuples(value: AST) -> AST:
    if isinstance(value, IfExp):
        return at(IfExp(value.test, _as_tuples(value.body), _as_tuples(value.orelse)), value)
    return at(tuple_of(*map(_as_tuples, value.elts)), value) if isinstance(value, (Tuple, List)) else value


def _items(value: AST) -> list[AST]:
    return [i for item in value.elts for i in _items(item)] if isinstance(value, Tuple) else [value]
