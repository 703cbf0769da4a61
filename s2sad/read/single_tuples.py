"""single_tuples: a function that returns a tuple of one value returns the value, and its calls are spelled as tuples.

    def square(x): return (x * x,)          def square(x): return x * x
    y, = square(x)                          y, = (square(x),)
    return square(y)[0]                     return (square(y),)[0]

So every call has either one value, which is no tuple, or several. Lists of one go the same way. The derivatives that
s2sad writes return such tuples.
Requires resolved names.
"""
from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.program import Kernel
from s2sad.tree import AST


def single_tuples(kernels: dict[str, Kernel], kept: Collection[str]) -> dict[str, Kernel]:
    """The kernels, of which callees are first; those in `kept`, for whose results others ask, return what they did."""
    kernels = dict(kernels)
    of_one: dict[str, type] = {}
    for n, kernel in list(kernels.items()):
        definition = _spelled(kernel.tree, of_one)
        returns = [s for s in tree.walk(definition.body) if isinstance(s, tree.Return) and s.value is not None]
        made = {_made_of_one(s.value) for s in returns}
        if n not in kept and kernel.own is None and len(made) == 1 and None not in made:
            of_one[n] = made.pop()
            definition = tree.rebuild(definition, lambda s: tree.at(tree.Return(_only(s.value)), s) if isinstance(
                s, tree.Return) and s.value is not None else None)
        if definition is not kernel.tree:
            kernels[n] = replace(kernel, tree=definition)
    return kernels


def _made_of_one(value: AST) -> Any:
    """`Tuple` or `List` of one item, None for everything else."""
    if isinstance(value, tree.IfExp):
        made = _made_of_one(value.body)
        return made if made is _made_of_one(value.orelse) else None
    alone = isinstance(value, (tree.Tuple, tree.List)) and len(value.elts) == 1
    return type(value) if alone and not isinstance(value.elts[0], tree.Starred) else None


def _only(value: AST) -> AST:
    """The one item; of a choice between tuples the choice between their items."""
    if isinstance(value, tree.IfExp):
        return tree.at(tree.IfExp(value.test, _only(value.body), _only(value.orelse)), value)
    return value.elts[0]


def _spelled(definition: AST, of_one: dict[str, type]) -> AST:
    """The definition with `f(x)` as `(f(x),)` for each of these functions, except where nothing takes the value."""
    def spelling(node: AST) -> Any:
        return of_one.get((tree.call_name(node) or "").removeprefix("user.")) if isinstance(node, tree.Call) else None

    def called(node: AST) -> AST:
        return tree.at(tree.Call(node.func, *(tree.rebuild(part, change) for part in (node.args, node.keywords))), node)

    def change(node: AST) -> AST | None:
        if isinstance(node, tree.Expr) and spelling(node.value):
            return tree.at(tree.Expr(called(node.value)), node)
        made = spelling(node)
        return tree.at(made([called(node)], tree.Load()), node) if made else None
    return tree.rebuild(definition, change) if any(map(spelling, tree.walk(definition))) else definition
