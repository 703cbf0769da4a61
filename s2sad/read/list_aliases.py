"""list_aliases: a list under a name that stands in what is spelled out, and is written behind it.

    us = [x[0], x[1]]
    t = (us, 2.0)
    us[0] = x[2]            refused: Python's t holds the new number, and would hold a copy here

    shared_lists.check(function, report)    before names are resolved; one S201 for each tuple or list

A list that nothing writes from there on is as good as a copy, and so is one that is bound anew before it is written.
"""
from __future__ import annotations

from s2sad import tree
from s2sad.diagnostics import Report
from s2sad.tree import AST


def check(function: AST, report: Report) -> None:
    """Reports every tuple or list that holds a list which is written, not a copy of it."""
    if not isinstance(function, tree.FunctionDef):
        return
    lists = {t.id for s in tree.walk(function.body) for t in _targets(s) if isinstance(t, tree.Name)
             and isinstance(getattr(s, "value", None), tree.List)}
    if not lists:
        return
    found = _ListUses(function, lists)
    for statement in tree.walk(function.body):
        for shown in [d for value in _values(statement) for d in _displays(value)]:
            held = [n for n in shown.elts if isinstance(n, tree.Name) and n.id in lists]
            if any(found.written(n, statement) for n in held):
                report.error("S201", "a tuple or a list holds a list that is written, not a copy of it", shown,
                             help="put the items into it: [us[0], us[1]]")


def _targets(statement: AST) -> list[AST]:
    if isinstance(statement, tree.Assign):
        return list(statement.targets)
    return [statement.target] if isinstance(statement, tree.AnnAssign) else []


def _values(statement: AST) -> list[AST]:
    """What a statement binds, stores or appends."""
    if _targets(statement):
        return [v for v in [statement.value] if v is not None]
    called = statement.value if isinstance(statement, tree.Expr) else None
    return called.args if isinstance(called, tree.Call) and isinstance(called.func, tree.Attribute) else []


def _displays(value: AST) -> list[tree.Tuple | tree.List]:
    """What is spelled out in a value and stays; not what a function is given, and no subscript."""
    if isinstance(value, (tree.Tuple, tree.List)):
        return [value, *(d for item in value.elts for d in _displays(item))]
    if isinstance(value, (tree.Call, tree.Subscript)):
        return []
    return [d for child in tree.children(value) for d in _displays(child)]


class _ListUses:
    """What one function's text says of its lists: the order of its nodes, what binds and what writes."""

    def __init__(self, function: tree.FunctionDef, lists: set[str]):
        self.lists = lists
        self.order: dict[int, int] = {}
        self.blocks: dict[int, tuple[int, ...]] = {}        # of each node the blocks that it is in
        self.loops: list[AST] = []
        self.statements: list[AST] = []
        self._walk(function.body, ())
        nodes = [n for s in function.body for n in tree.walk(s)]
        self.stores = [n for n in nodes if isinstance(n, tree.Subscript) and not isinstance(n.ctx, tree.Load)]

    def _walk(self, block: list[AST], around: tuple[int, ...]) -> None:
        here = (*around, id(block))
        for statement in block:
            self.statements.append(statement)
            if isinstance(statement, (tree.For, tree.While)):
                self.loops.append(statement)
            inner = [b for f in ("body", "orelse") if isinstance(b := getattr(statement, f, None), list)]
            within = {id(n) for b in inner for n in tree.walk(b)}
            for node in tree.walk(statement):
                if id(node) not in within:
                    self.order[id(node)] = len(self.order)
                    self.blocks[id(node)] = here
            for b in inner:
                self._walk(b, here)

    def written(self, held: tree.Name, statement: AST) -> bool:
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
        return [s for s in self.loops if {id(n) for n in nodes} <= set(map(id, tree.walk(s.body)))]

    def _anew(self, identifier: str, store: AST, statement: AST) -> bool:
        """Whether on every way from a statement to a store the name is bound to another list."""
        here, place, around = self.blocks[id(store)], self.order[id(store)], self._common(store, statement)
        inner = set(map(id, tree.walk(around[-1].body))) if around else set()
        return any(self.blocks[id(s)] == here[:len(self.blocks[id(s)])] and self.order[id(s)] < place and (
            self.order[id(s)] > self.order[id(statement)] or id(s) in inner)
            for s in self.statements if any(_is_name(t, identifier) for t in _targets(s)))

    def _holders(self, statement: AST) -> set[str]:
        """The names that what is spelled out is bound to, and those that it is handed on to."""
        called = getattr(statement.value, "func", None)
        holding = [called.value] if isinstance(called, tree.Attribute) else _targets(statement)
        found = {n for t in holding if (n := _root(t))}
        while True:
            more = {n for s in self.statements for t in _targets(s) if (n := _root(t)) and found & set(
                tree.names(s.value) if s.value is not None else [])} - self.lists
            if more <= found:
                return found
            found |= more


def _root(node: AST) -> str:
    while isinstance(node, tree.Subscript):
        node = node.value
    return node.id if isinstance(node, tree.Name) else ""


def _is_name(node: AST, identifier: str) -> bool:
    return isinstance(node, tree.Name) and node.id == identifier


def _path(statement: AST, shown: AST) -> list[int] | None:
    """The places that lead from a statement's value to what is spelled out in it; None if it is not there for sure."""
    def within(node: AST) -> list[int] | None:
        if node is shown:
            return []
        for k, item in enumerate(node.elts if isinstance(node, (tree.Tuple, tree.List)) else ()):
            inner = within(item)
            if inner is not None:
                return [k, *inner]
        return None
    targets = _targets(statement)
    return within(statement.value) if targets and isinstance(targets[0], tree.Name) else None


def _reaches(store: AST, path: list[int] | None) -> bool:
    """Whether a store into an item of an item may be one into a list there."""
    places: list[AST] = []
    while isinstance(store, tree.Subscript):
        places.insert(0, store.slice)
        store = store.value
    known = [p.value if isinstance(p, tree.Constant) else None for p in places]
    return len(places) > 1 and (path is None or all(k is None or type(k) is not int or k == p
                                                    for k, p in zip(known, path)))
