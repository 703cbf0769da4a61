"""late_reads: a loop over a list whose items are written in the loop reads each item when its round comes.

    vs = [x[0], x[1]]               vs = [x[0], x[1]]
    for v in vs:                    for v in (builtins.next(vs[0]), builtins.next(vs[1])):
        vs[1] *= 2.0                    vs[1] *= 2.0
        s += v                          s += v

Requires lists of a known length. A tuple that is written where the loop is, a copy or a part of a list is made before
the first round, and so is a list that the loop binds anew. `loops` reads the marked items in their rounds.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping

from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Attribute, AugAssign, Call, For, FunctionDef, Name, Store, Subscript, at, call, call_name, const, copy, index,
    name, rebuild, stored_names, tuple_of, walk,
)

_NOW = "builtins.next"                  # what a loop goes through is no iterator: no user's call is one
THROUGH = ("builtins.enumerate", "builtins.zip", "builtins.reversed")


def late_reads(function: FunctionDef, lengths: Mapping[str, int], scope: KernelScope) -> FunctionDef:
    """The function in which loops over lists of these lengths, by their names, have their items marked."""
    def change(node: AST) -> AST | None:
        if not isinstance(node, For):
            return None
        new = copy(node)
        new.body = [rebuild(s, change) for s in node.body]
        new.orelse = [rebuild(s, change) for s in node.orelse]
        written = _written([node.target, *node.body]) & set(lengths)
        gone = {n.id for n in _lists(node.iter) if n.id in written}
        for n in sorted(gone & set(stored_names([node.target, *node.body]))):
            scope.refuse(node.iter, f"a loop over {n!r} writes items of the list, and binds the name to another list",
                         help="give the other list another name")
        new.iter = _spelled(node.iter, {n: lengths[n] for n in gone})
        return new
    return rebuild(function, change) if lengths else function


def in_its_round(item: AST) -> AST:
    """The item of a list, to be read when its round comes."""
    return at(call(_NOW, item), item)


def is_read_late(item: AST) -> bool:
    """Whether an item is to be read when its round comes."""
    return call_name(item) == _NOW


def plain_item(item: AST) -> AST:
    """An item without the mark."""
    return rebuild(item, lambda n: plain_item(n.args[0]) if is_read_late(n) else None)


def root(node: AST) -> str:
    """The name of which a part is meant; "" if it has none."""
    while isinstance(node, (Subscript, Attribute)):
        node = node.value
    return node.id if isinstance(node, Name) else ""


def _written(nodes: Iterable[AST]) -> set[str]:
    """The names of which parts are written, and those that calls are given, which may write them."""
    found: set[str] = set()
    for node in walk(list(nodes)):
        if isinstance(node, (Subscript, Attribute)) and isinstance(node.ctx, Store):
            found.add(root(node))
        elif isinstance(node, AugAssign) and isinstance(node.target, Name):
            found.add(node.target.id)
        elif isinstance(node, Call) and (call_name(node) or "").startswith("user."):
            found |= {n.id for n in walk([*node.args, *node.keywords]) if isinstance(n, Name)}
    return found


def _lists(iterable: AST) -> list[Name]:
    """The lists that a loop goes through as they are."""
    if isinstance(iterable, Name):
        return [iterable]
    return [n for a in iterable.args for n in _lists(a)] if call_name(iterable) in THROUGH else []


def _spelled(iterable: AST, lengths: Mapping[str, int]) -> AST:
    if isinstance(iterable, Name) and iterable.id in lengths:
        items = [in_its_round(at(index(name(iterable.id), const(k)), iterable)) for k in range(lengths[iterable.id])]
        return at(tuple_of(*items), iterable)
    if call_name(iterable) not in THROUGH:
        return iterable
    new = copy(iterable)
    new.args = [_spelled(a, lengths) for a in iterable.args]
    return new
