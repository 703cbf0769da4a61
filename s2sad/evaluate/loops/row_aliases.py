"""row_aliases: a list under a name that is put into another list is copied; where that would tell, it is refused.

    w = [x[0], x[1]]
    h.append(w)             or h = [w, v], h[0] = w
    w[0] = 0.0              refused: Python's h holds the new number

Requires resolved names; changes nothing. Only lists that are spelled out are asked about: the others are arrays, of
which `listed` takes care.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.call_types import LISTED
from s2sad.evaluate.effects import bindings
from s2sad.tree import (
    AST, Assign, For, FunctionDef, List, Name, Store, Subscript, While, call_name, names, stored_names, walk,
)

Appended = Callable[[AST], str | None]          # the name of the list that a statement appends to
COPIED = "append a copy: .append(list(w))"


def row_aliases(function: FunctionDef, appended: Appended) -> list[AST]:
    """The statements that put such a list into another one, where a write of one of them would tell."""
    nodes = list(walk(function.body))
    order = {id(n): k for k, n in enumerate(nodes)}
    bound = [(s.targets[0].id, s) for s in nodes if isinstance(s, Assign) and isinstance(s.targets[0], Name)]
    spelled = {n for n, s in bound if isinstance(s.value, List) and s.value.elts}
    lists = {n for n, s in bound if isinstance(s.value, List) or call_name(s.value) == LISTED}
    written = [n for n in nodes if isinstance(n, Subscript) and isinstance(n.ctx, Store)]
    found = []
    for store, outer, value, several in ((s, *put) for s in nodes for put in _puts(s, appended, spelled)):
        before = [order[id(s)] for n, s in bound if n == value and order[id(s)] < order[id(store)]]
        if outer not in lists or value not in spelled or not before:
            continue
        own = {id(n) for n in walk(store)}
        again = _again(store, [n for n in nodes if isinstance(n, (For, While)) and order[id(n)] > max(before)])
        ends = min((order[id(s)] for n, s in bound if n == value and order[id(s)] > order[id(store)]),
                   default=len(order))
        later = {id(n) for n in nodes if isinstance(n, Name) and n.id == value and id(n) not in own and (
            order[id(store)] < order[id(n)] < ends or id(n) in again)}
        by_others = {n for t, v in bindings(function) if outer in names(v) for n in stored_names(t)} - {outer}
        rows = any(n in by_others or n == outer and isinstance(w.value, Subscript)
                   for w in written for n in [getattr(_base(w), "id", "")])
        if later & {id(_base(w)) for w in written} or (later or again or several) and rows:
            found.append(store)
    return found


def _puts(store: AST, appended: Appended, spelled: set[str]) -> list[tuple[str, str, bool]]:
    """The names of a list and of those that a statement puts into it, and whether it does so more than once."""
    outer, target = appended(store), store.targets[0] if isinstance(store, Assign) else None
    value = store.value.args[0] if outer else getattr(store, "value", None)
    if isinstance(target, Name) and isinstance(value, List):
        held = [i.id for i in value.elts if isinstance(i, Name) and i.id in spelled]
        return [(target.id, n, held.count(n) > 1) for n in dict.fromkeys(held)]
    outer = outer or (_base(target).id if isinstance(target, Subscript) and isinstance(_base(target), Name) else "")
    return [(outer, value.id, False)] if outer and isinstance(value, Name) else []


def _again(store: AST, loops: list[AST]) -> set[int]:
    """What is in the loops around a store that a list is there before."""
    return {id(n) for loop in loops if any(m is store for m in walk(loop.body)) for n in walk(loop.body)}


def _base(node: AST) -> AST:
    while isinstance(node, Subscript):
        node = node.value
    return node
