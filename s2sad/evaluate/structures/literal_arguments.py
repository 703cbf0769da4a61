"""Which names hold tuples and lists that are spelled out, and go to functions of the user's.

    t = (a, b)                  h(t)   ->   h((t[0], t[1])), which is taken apart like what is written at the call
    us = [a, b]
    us[0] = c                   h(us)  ->   h([us[0], us[1]])

A name is one of these if every binding spells out, or returns from a function, as many items in the same nesting, and
nothing else makes a list of it longer or puts another list in an item's place.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from s2sad.infer.signatures.laws import constant_slice
from s2sad.evaluate.argument_binding import result_structure, user_call
from s2sad.evaluate.expressions.hoist import constant_index
from s2sad.evaluate.effects import bindings, parameters
from s2sad.program import Program
from s2sad.tree import (
    AST, Assign, Attribute, Call, Constant, FunctionDef, IfExp, List, Load, Name, Slice, Store, Subscript, Tuple, at,
    const, copy, index, names, walk, walk_statements,
)

Nest = tuple[Any, ...]          # "tuple" or "list", and what each item is: a nest, or None for any other value
DISPLAYS = {Tuple: "tuple", List: "list"}


def given_names(function: FunctionDef) -> set[str]:
    """The names that calls of user's functions are given, and those that are copied to these or put into them."""
    found = {n.id for call in walk(function.body) for a in arguments(call) for n in _shown(a)}
    while True:
        more = {n.id for target, value in bindings(function) if isinstance(target, Name) and target.id in found
                for n in _shown(value)}
        if more <= found:
            return found
        found |= more


def arguments(node: AST) -> list[AST]:
    """What a call of a user's function is given."""
    if not isinstance(node, Call) or user_call(node) is None:
        return []
    return [*node.args, *(k.value for k in node.keywords)]


def gives_tuples(function: FunctionDef, program: Program) -> bool:
    """Whether a function gives another one a tuple or a list, as far as the text shows it."""
    given = [_whole(a) for call in walk(function.body) for a in arguments(call)]
    if any(isinstance(a, (Tuple, List)) or _returns_several(a, program) for a in given):
        return True
    held = given_names(function)
    parts = {n for a in given if isinstance(a, Subscript) for n in names(a.value)}
    for target, value in bindings(function):
        bound = {n.id for n in walk(target) if isinstance(n, Name)}
        inside = any(_is_display(n) for n in walk(value) if n is not value)
        if isinstance(target, Name) and bound & held and _is_several(value, program) or (
                not isinstance(target, Name) and bound & held or _is_display(value) and bound & parts) and inside:
            return True
    return False


def nests(function: FunctionDef, program: Program) -> dict[str, Nest]:
    """The names that hold such tuples and lists, with how many items they have and which of these are some again."""
    values: dict[str, list[AST]] = {}
    for target, value in bindings(function):
        if isinstance(target, Name):
            values.setdefault(target.id, []).append(value)
    stores = [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
    odd = {*parameters(function), *(n for n, v in values.items() if stores.count(n) != len(v)), *_grown(function)}
    known: dict[str, Nest] = {}
    for _ in range(len(values) + 2):
        found = {n: nest for n, v in values.items() if n not in odd and (nest := _one([
            _nest(each, known, program) for each in v])) is not None}
        if found == known:
            return {n: nest for n, nest in known.items() if not _replaced(function, n, nest, known, program)}
        known = found
    return {}                                   # a name that goes into itself: `t = (t, a)`


def by_item(node: AST, known: Mapping[str, Nest]) -> Tuple | List | None:
    """Such a name, an item of one that has items, or a slice of one, as what is spelled out; None for anything else."""
    if isinstance(node, Name):
        return _spelled(node, known[node.id]) if node.id in known else None
    if not isinstance(node, Subscript):
        return None
    base, place = by_item(node.value, known), constant_index(node)
    part = constant_slice(node.slice) if isinstance(node.slice, Slice) else None
    if base is None or part is None and (place is None or not -len(base.elts) <= place < len(base.elts)):
        return None
    if part is not None:
        return at(type(base)(base.elts[part], base.ctx), node)
    item = base.elts[place or 0]
    return item if isinstance(item, (Tuple, List)) else None


def _spelled(node: AST, nest: Nest) -> Tuple | List:
    read = [at(index(copy(node), const(k)), node) for k in range(len(nest) - 1)]
    items = [r if inner is None else _spelled(r, inner) for r, inner in zip(read, nest[1:])]
    return at(Tuple(items, Load()) if nest[0] == "tuple" else List(items, Load()), node)


def _one(found: list[Nest | None]) -> Nest | None:
    return found[0] if found and all(f == found[0] for f in found) else None


def _nest(value: AST, known: dict[str, Nest], program: Program) -> Nest | None:
    if isinstance(value, (Tuple, List)):
        items = [i.value if isinstance(i, Constant) else 0.0 for i in value.elts]
        if any(isinstance(i, (str, type(None))) for i in items) or any(type(i).__name__ == "Starred"
                                                                       for i in value.elts):
            return None
        return (DISPLAYS[type(value)], *(_nest(i, known, program) for i in value.elts))
    if isinstance(value, IfExp):
        return _one([_nest(value.body, known, program), _nest(value.orelse, known, program)])
    if isinstance(value, Name):
        return known.get(value.id)
    if isinstance(value, Subscript):
        base, place = _nest(value.value, known, program), constant_index(value)
        inside = base is not None and place is not None and -len(base) < place < len(base) - 1
        return base[1:][place] if base is not None and place is not None and inside else None
    return _of_result(result_structure(user_call(value) or "", program))


def _of_result(structure: Any) -> Nest | None:
    return None if structure is None else ("tuple", *map(_of_result, structure))


def _grown(function: FunctionDef) -> Iterator[str]:
    """The names whose methods are called, that a sum makes longer, or of which a part is written."""
    for node in walk(function.body):
        if isinstance(node, Attribute) and isinstance(node.value, Name):
            yield node.value.id
        if type(node).__name__ == "Delete":
            yield from names(node)
        if isinstance(node, Subscript) and isinstance(node.ctx, Store) and type(node.slice).__name__ == "Slice":
            yield from names(node.value)


def _replaced(function: FunctionDef, identifier: str, nest: Nest, known: dict[str, Nest], program: Program) -> bool:
    """Whether an item of a list is replaced by what has another nesting, or may be."""
    for node in walk_statements(function.body):
        for target in node.targets if isinstance(node, Assign) else ():
            if isinstance(target, Subscript) and isinstance(target.value, Name) and target.value.id == identifier:
                place = constant_index(target)
                old = nest[1:][place] if place is not None and -len(nest) < place < len(nest) - 1 else None
                flat = place is not None or not any(nest[1:])
                if not flat or _nest(node.value, known, program) != old:
                    return True
    return False


def _whole(value: AST) -> AST:
    """What a slice is taken of."""
    return value.value if isinstance(value, Subscript) and isinstance(value.slice, Slice) else value


def _is_display(node: AST) -> bool:
    return isinstance(node, (Tuple, List)) and not isinstance(node.ctx, Store)


def _is_several(value: AST, program: Program) -> bool:
    if isinstance(value, IfExp):
        return _is_several(value.body, program) or _is_several(value.orelse, program)
    return _is_display(value) or _returns_several(value, program)


def _returns_several(value: AST, program: Program) -> bool:
    called = user_call(value)
    return called is not None and result_structure(called, program) is not None


def _shown(value: AST) -> Iterator[Name]:
    """The names that a value is, or that stand as items in what it spells out."""
    value = _whole(value)
    if isinstance(value, Name):
        yield value
    elif isinstance(value, (Tuple, List)):
        for item in value.elts:
            yield from _shown(item)
    elif isinstance(value, IfExp):
        yield from _shown(value.body)
        yield from _shown(value.orelse)
