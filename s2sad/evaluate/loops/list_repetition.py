"""list_repetition: a list that repeats a number becomes a comprehension, one of None a list that is yet to be filled.

    z = [0.0] * n                           z = [0.0 for each in range(n)]
    t = [[0.0] * n for i in range(m)]       t = [[0.0 for each in range(n)] for i in range(m)]
    gains = [None] * n                      gains = builtins.list(n)

Requires resolved names. A written number of elements stays what it is, unless a variable tells which one is written.
"""
from __future__ import annotations

from s2sad.infer.call_types import LISTED
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Assign, BinOp, Compare, Constant, FunctionDef, List, ListComp, Mult, Name, Store, Subscript, UnaryOp, at,
    call, const, copy, expression, names, rebuild, rename, walk,
)


def list_repetition(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function with such lists in that form."""
    nodes = list(walk(function.body))
    picked = {n.value.id for n in nodes if isinstance(n, Subscript) and isinstance(n.ctx, Store) and isinstance(
        n.value, Name) and names(n.slice)}
    stores = [n.id for n in nodes if isinstance(n, Name) and isinstance(n.ctx, Store)]
    tested = {n for c in nodes if isinstance(c, Compare) for n in names(c)}

    def change(node: AST) -> AST | None:
        if isinstance(node, ListComp) and (found := _repeated(node.elt)) is not None:
            new = copy(node)
            new.elt = at(_comprehension(*found, scope), node.elt)
            return new
        target = node.targets[0] if isinstance(node, Assign) and len(node.targets) == 1 else None
        found = _repeated(node.value) if isinstance(target, Name) and isinstance(node, Assign) else None
        if found is None or not isinstance(target, Name) or stores.count(target.id) > 1:
            return None
        item, count = found
        if isinstance(count, Constant) and target.id not in picked:
            return None
        new = copy(node)
        empty = isinstance(item, Constant) and item.value is None
        if empty and (target.id not in picked or target.id in tested):
            return None
        new.value = at(call(LISTED, count) if empty else _comprehension(item, count, scope), node.value)
        return new
    return rebuild(function, change)


def _repeated(value: AST) -> tuple[AST, AST] | None:
    """The one item of a list that is repeated, and how often."""
    if isinstance(value, List) and value.elts and all(isinstance(i, Constant) and i.value is None for i in value.elts):
        return value.elts[0], const(len(value.elts))
    if not isinstance(value, BinOp) or not isinstance(value.op, Mult):
        return None
    for item, count in ((value.left, value.right), (value.right, value.left)):
        if isinstance(item, List) and len(item.elts) == 1 and isinstance(
                item.elts[0].operand if isinstance(item.elts[0], UnaryOp) else item.elts[0], Constant):
            return item.elts[0], count
    return None


def _comprehension(item: AST, count: AST, scope: KernelScope) -> AST:
    made = expression("[item for each in count]")
    made.elt = item
    made.generators[0].iter = call("builtins.range", count)
    return rename(made, {"each": scope.fresh("each")})
