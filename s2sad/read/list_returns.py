"""list_returns: a list under a name that is returned is spelled out there.

    us = [a, b]                     us = [a, b]
    us[0] = c                       us[0] = c
    return us, x[2]                 return [us[0], us[1]], x[2]

A name is one of such a list if every binding spells out as many items in the same nesting, and nothing makes it longer.
A returned list is a tuple from there on (`structured`), except where the caller picks with it (`fields`). The same
is done for a name of a tuple of one, as `tuples_of_one` reads the returns.
"""
from __future__ import annotations

from typing import Any

from s2sad.tree import (
    AST, AnnAssign, Assign, Attribute, Constant, Dict, FunctionDef, IfExp, List, Load, Name, Return, Slice, Starred,
    Subscript, Tuple, at, const, copy, index, rebuild, walk, with_body,
)

Nest = tuple[Any, ...]      # what is spelled out, a tuple or a list, and for each item its own nest, or None


def list_returns(function: FunctionDef) -> FunctionDef:
    """The function that returns such lists spelled out."""
    if not isinstance(function, FunctionDef) or not any(isinstance(n, (Tuple, List)) for n in walk(
            function.body)):
        return function
    known = _nests(function)
    lists = {n for n, values in _bound(function).items() if any(isinstance(v, List) for v in values)}

    def change(node: AST) -> AST | None:
        if type(node).__name__ in ("FunctionDef", "Lambda"):
            return node                         # these are read on their own
        if not isinstance(node, Return) or node.value is None:
            return None
        value = node.value
        nest = known.get(value.id, ()) if isinstance(value, Name) else ()
        if isinstance(value, Name) and value.id not in lists and not any(nest[1:]) and len(nest) != 2:
            return None
        return at(Return(_spelled(value, known)), node)
    return with_body(function, [rebuild(s, change) for s in function.body])


def _spelled(value: AST, known: dict[str, Nest]) -> AST:
    if isinstance(value, (Tuple, List)):
        return at(type(value)([_spelled(v, known) for v in value.elts], Load()), value)
    if isinstance(value, IfExp):
        return at(IfExp(value.test, _spelled(value.body, known), _spelled(value.orelse, known)), value)
    if isinstance(value, Dict):
        return at(Dict(value.keys, [_spelled(v, known) for v in value.values]), value)
    return _items(value, known[value.id]) if isinstance(value, Name) and value.id in known else value


def _items(node: AST, nest: Nest) -> AST:
    read = [at(index(copy(node), const(k)), node) for k in range(len(nest) - 1)]
    return at(nest[0]([r if inner is None else _items(r, inner) for r, inner in zip(read, nest[1:])], Load()), node)


def _bound(function: FunctionDef) -> dict[str, list[AST | None]]:
    """What each name is bound to; None for what is not a plain assignment."""
    found: dict[str, list[AST | None]] = {}
    plain: set[int] = set()
    for statement in walk(function.body):
        targets = statement.targets if isinstance(statement, Assign) else [statement.target] if isinstance(
            statement, AnnAssign) and statement.value is not None else []
        for target in targets:
            if isinstance(target, Name):
                found.setdefault(target.id, []).append(statement.value)
                plain.add(id(target))
    for node in walk(function):
        if isinstance(node, Name) and not isinstance(node.ctx, Load) and id(node) not in plain:
            found.setdefault(node.id, []).append(None)
    return found


def _nests(function: FunctionDef) -> dict[str, Nest]:
    odd = {n.value.id for n in walk(function.body) if isinstance(n, Attribute) and isinstance(n.value, Name)}
    odd |= {n.value.id for n in walk(function.body) if isinstance(n, Subscript) and isinstance(n.value, Name)
            and not isinstance(n.ctx, Load) and isinstance(n.slice, Slice)}
    bound = {n: values for n, values in _bound(function).items() if n not in odd}
    known: dict[str, Nest] = {}
    for _ in range(len(bound) + 2):
        found: dict[str, Nest] = {}
        for name, values in bound.items():
            nests = [_nest(v, known) for v in values]
            if nests[0] is not None and all(n == nests[0] for n in nests):
                found[name] = nests[0]
        if found == known:
            return known
        known = found
    return {}                                   # a name that goes into itself: `us = [us, a]`


def _nest(value: AST | None, known: dict[str, Nest]) -> Nest | None:
    if isinstance(value, Name):
        return known.get(value.id)
    if not isinstance(value, (Tuple, List)) or not value.elts or any(isinstance(v, Starred) or isinstance(
            v, Constant) and (v.value is None or isinstance(v.value, str)) for v in value.elts):
        return None
    return (type(value), *(_nest(v, known) for v in value.elts))
