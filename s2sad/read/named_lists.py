"""named_lists: lists under names, before names are resolved: where they are put into others, and where returned."""
from __future__ import annotations

from typing import Any

from s2sad.diagnostics import Report
from s2sad.tree import (
    AST, AnnAssign, Assign, Attribute, Call, Constant, Dict, Expr, For, FunctionDef, IfExp, List, Load, Name, Return,
    Slice, Starred, Subscript, Tuple, While, at, children, const, copy, index, names, rebuild, walk, with_body,
)

Nest = tuple[Any, ...]      # what is spelled out, a tuple or a list, and for each item its own nest, or None


def list_aliases(function: AST, report: Report) -> None:
    """Refuses a tuple or list that holds a list under a name which is stored into later: it would hold a copy here.

    us = [x[0], x[1]]
    t = (us, 2.0)
    us[0] = x[2]            refused: Python's t holds the new number

    A list that nothing stores into from there on is as good as a copy, and so is one that is bound anew before.
    """
    if not isinstance(function, FunctionDef):
        return
    lists = {t.id for s in walk(function.body) for t in _targets(s) if isinstance(t, Name)
             and isinstance(getattr(s, "value", None), List)}
    if not lists:
        return
    found = _ListUses(function, lists)
    for statement in walk(function.body):
        for shown in [d for value in _values(statement) for d in _displays(value)]:
            held = [n for n in shown.elts if isinstance(n, Name) and n.id in lists]
            if any(found.written(n, statement) for n in held):
                report.error("S201", "a tuple or a list holds a list that is written, not a copy of it", shown,
                             help="put the items into it: [us[0], us[1]]")


def _targets(statement: AST) -> list[AST]:
    if isinstance(statement, Assign):
        return list(statement.targets)
    return [statement.target] if isinstance(statement, AnnAssign) else []


def _values(statement: AST) -> list[AST]:
    """What a statement binds, stores or appends."""
    if _targets(statement):
        return [v for v in [statement.value] if v is not None]
    called = statement.value if isinstance(statement, Expr) else None
    return called.args if isinstance(called, Call) and isinstance(called.func, Attribute) else []


def _displays(value: AST) -> list[Tuple | List]:
    """What is spelled out in a value and stays; not what a function is given, and no subscript."""
    if isinstance(value, (Tuple, List)):
        return [value, *(d for item in value.elts for d in _displays(item))]
    if isinstance(value, (Call, Subscript)):
        return []
    return [d for child in children(value) for d in _displays(child)]


class _ListUses:
    """What one function's text says of its lists: the order of its nodes, what binds them and what stores into them."""

    def __init__(self, function: FunctionDef, lists: set[str]):
        self.lists = lists
        self.order: dict[int, int] = {}
        self.blocks: dict[int, tuple[int, ...]] = {}        # of each node the blocks that it is in
        self.loops: list[AST] = []
        self.statements: list[AST] = []
        self._walk(function.body, ())
        nodes = [n for s in function.body for n in walk(s)]
        self.stores = [n for n in nodes if isinstance(n, Subscript) and not isinstance(n.ctx, Load)]

    def _walk(self, block: list[AST], around: tuple[int, ...]) -> None:
        here = (*around, id(block))
        for statement in block:
            self.statements.append(statement)
            if isinstance(statement, (For, While)):
                self.loops.append(statement)
            inner = [b for f in ("body", "orelse") if isinstance(b := getattr(statement, f, None), list)]
            within = {id(n) for b in inner for n in walk(b)}
            for node in walk(statement):
                if id(node) not in within:
                    self.order[id(node)] = len(self.order)
                    self.blocks[id(node)] = here
            for b in inner:
                self._walk(b, here)

    def written(self, held: Name, statement: AST) -> bool:
        """Whether a list may be written behind a statement that puts it into a tuple or list, by its name or through
        what it is in."""
        holders, path = self._holders(statement), _path(statement, held)
        for store in self.stores:
            name = _root(store)
            reaches = name == held.id and not self._anew(name, store, statement) or name in holders and _reaches(
                store, path)
            if reaches and (self.order[id(store)] > self.order[id(statement)] or self._common(store, statement)):
                return True
        return False

    def _common(self, *nodes: AST) -> list[AST]:
        """The loops around all of these nodes, from the outside in."""
        return [s for s in self.loops if {id(n) for n in nodes} <= set(map(id, walk(s.body)))]

    def _anew(self, identifier: str, store: AST, statement: AST) -> bool:
        """Whether on every way from a statement to a store the name is bound to another list."""
        here, place, around = self.blocks[id(store)], self.order[id(store)], self._common(store, statement)
        inner = set(map(id, walk(around[-1].body))) if around else set()
        return any(self.blocks[id(s)] == here[:len(self.blocks[id(s)])] and self.order[id(s)] < place and (
            self.order[id(s)] > self.order[id(statement)] or id(s) in inner)
            for s in self.statements if any(_is_name(t, identifier) for t in _targets(s)))

    def _holders(self, statement: AST) -> set[str]:
        """The names that what is spelled out is bound to, and those that it is handed on to."""
        called = getattr(statement.value, "func", None)
        holding = [called.value] if isinstance(called, Attribute) else _targets(statement)
        found = {n for t in holding if (n := _root(t))}
        while True:
            more = {n for s in self.statements for t in _targets(s) if (n := _root(t)) and found & set(
                names(s.value) if s.value is not None else [])} - self.lists
            if more <= found:
                return found
            found |= more


def _root(node: AST) -> str:
    while isinstance(node, Subscript):
        node = node.value
    return node.id if isinstance(node, Name) else ""


def _is_name(node: AST, identifier: str) -> bool:
    return isinstance(node, Name) and node.id == identifier


def _path(statement: AST, shown: AST) -> list[int] | None:
    """The places that lead from a statement's value to what is spelled out in it; None if it is not there for sure."""
    def within(node: AST) -> list[int] | None:
        if node is shown:
            return []
        for k, item in enumerate(node.elts if isinstance(node, (Tuple, List)) else ()):
            inner = within(item)
            if inner is not None:
                return [k, *inner]
        return None
    targets = _targets(statement)
    return within(statement.value) if targets and isinstance(targets[0], Name) else None


def _reaches(store: AST, path: list[int] | None) -> bool:
    """Whether a store into an item of an item may be one into a list there."""
    places: list[AST] = []
    while isinstance(store, Subscript):
        places.insert(0, store.slice)
        store = store.value
    known = [p.value if isinstance(p, Constant) else None for p in places]
    return len(places) > 1 and (path is None or all(k is None or type(k) is not int or k == p
                                                    for k, p in zip(known, path)))


def list_returns(function: FunctionDef) -> FunctionDef:
    """The function in which a list under a name that is returned is spelled out there.

    us = [a, b]                     us = [a, b]
    us[0] = c                       us[0] = c
    return us, x[2]                 return [us[0], us[1]], x[2]

    A name is one of such a list if every binding spells out as many items in the same nesting, and nothing makes it
    longer. A returned list is a tuple from there on (`single_exit`), except where the caller picks with it (`fields`).
    The same is done for a name of a tuple of one, as `single_tuples` reads the returns.
    """
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
