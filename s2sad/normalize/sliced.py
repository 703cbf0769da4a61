"""sliced: names of slices stand for the slices.

    inner = slice(1, -1)            v[1:-1] = u[1:-1, ::2]
    every = np.s_[::2]
    v[inner] = u[inner, every]

Requires resolved names. What a slice is made of must stay what it is; a slice that is no subscript is refused.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.memory import parameters
from s2sad.normalize.scope import Scope
from s2sad.tree import (
    AST, Assign, Constant, FunctionDef, Name, Slice, Store, Subscript, Tuple, assign, at, call_name, copy, names,
    rebuild, stored_names, tuple_of, walk,
)

_SLICE, _WRITTEN = "builtins.slice", "numpy.s_"


def sliced(function: FunctionDef, scope: Scope) -> FunctionDef:
    """The function without names of slices."""
    if not any(isinstance(n, Name) and n.id in (_SLICE, _WRITTEN) for n in walk(function.body)):
        return function
    function = copy(function)
    function.body = _separate(function.body)
    nodes = [n for n in walk(function.body) if isinstance(n, Name)]
    stores = [n.id for n in nodes if isinstance(n.ctx, Store)]
    known: dict[str, AST] = {}
    for statement in walk(function.body):
        target = statement.targets[0] if isinstance(statement, Assign) and len(statement.targets) == 1 else None
        if not isinstance(target, Name) or (found := _spelled(statement.value, known)) is None:
            continue
        lasting = all(stores.count(n) <= (n not in parameters(function)) for n in names(found))
        if stores.count(target.id) > 1 or not lasting or not _in_order(nodes, target, names(found)):
            scope.refuse(statement, "a slice whose name, or what it is made of, changes", help="write the slice "
                         "where it is used: x[a:b]")
        known[target.id] = found
    new = copy(function)
    new.body = _block(function.body, known)
    for node in walk(new.body):
        if call_name(node) == _SLICE or isinstance(node, Name) and node.id in known:
            scope.refuse(node, "a slice that is no subscript", help="write the slice where it is used: x[a:b]")
    return new


def one_by_one(statement: AST, wanted: Callable[[AST], bool]) -> list[AST]:
    """`us, vs = [], []` as two statements, if one of the values is wanted so and none reads a name that is bound."""
    target = statement.targets[0] if isinstance(statement, Assign) and len(statement.targets) == 1 else None
    value = statement.value if isinstance(statement, Assign) else None
    if not isinstance(target, Tuple) or not isinstance(value, Tuple) or len(target.elts) != len(value.elts):
        return [statement]
    plain = all(isinstance(t, Name) for t in target.elts) and not set(stored_names(target)) & set(names(value))
    fits = plain and any(map(wanted, value.elts))
    return [at(assign(t, v), statement) for t, v in zip(target.elts, value.elts)] if fits else [statement]


def _separate(block: list[AST]) -> list[AST]:
    made = []
    for statement in block:
        for field in ("body", "orelse"):
            if hasattr(statement, field):
                setattr(statement, field, _separate(getattr(statement, field)))
        made += one_by_one(statement, lambda value: _spelled(value, {}) is not None)
    return made


def _in_order(nodes: list[AST], target: Name, made_of: list[str]) -> bool:
    """Whether the text binds what a slice is made of, then the slice, and then uses it: so does each iteration."""
    here = next(k for k, n in enumerate(nodes) if n is target)
    return all(k < here for k, n in enumerate(nodes) if isinstance(n.ctx, Store) and n.id in made_of) and all(
        k >= here for k, n in enumerate(nodes) if n.id == target.id)


def _spelled(node: AST, known: dict[str, AST]) -> AST | None:
    """The slice, or the tuple with slices, that an expression stands for."""
    if call_name(node) == _SLICE and 0 < len(node.args) < 4 and not node.keywords:
        parts = [None if isinstance(a, Constant) and a.value is None else a for a in node.args]
        parts = [None, *parts] if len(parts) == 1 else parts
        return Slice(*[*parts, None][:3])
    if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id == _WRITTEN:
        return copy(node.slice)
    if isinstance(node, Name) and node.id in known:
        return copy(known[node.id])
    if isinstance(node, Tuple):
        found = [_spelled(e, known) for e in node.elts]
        return tuple_of(*(f or copy(e) for f, e in zip(found, node.elts))) if any(found) else None
    return None


def _block(block: list[AST], known: dict[str, AST]) -> list[AST]:
    def change(node: AST) -> AST | None:
        found = _spelled(node.slice, known) if isinstance(node, Subscript) else None
        if found is None:
            return None
        value = rebuild(node.value, change)
        parts = [part for s in (found.elts if isinstance(found, Tuple) else [found]) for part in (
            s.elts if isinstance(s, Tuple) else [s])]
        spelled = parts[0] if len(parts) == 1 else tuple_of(*parts)
        return at(Subscript(value, rebuild(spelled, change), node.ctx), node)

    made = []
    for statement in block:
        target = statement.targets[0] if isinstance(statement, Assign) else None
        if isinstance(target, Name) and target.id in known:
            continue
        new = copy(statement)
        for field in statement._fields:
            inner = getattr(statement, field)
            setattr(new, field, _block(inner, known) if field in ("body", "orelse") else rebuild(inner, change))
        made.append(new)
    return made
