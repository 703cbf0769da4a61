"""escaping_lists: lists that a kernel spells out and that become arrays, as lists that grow do.

    m = [np.zeros_like(x), x.copy()]                m = builtins.list(2)
    for t in range(n):                              m[0] = np.zeros_like(x)
        m[t % 2][:] = m[(t + 1) % 2] + x            m[1] = x.copy()
                                                    ...

One escapes if it holds arrays of which a variable picks one, or numbers of which a variable tells which is stored into.
A list whose elements are all picked by constants needs no array: its
elements are names, and may have different shapes.

Requires resolved names.
"""
from __future__ import annotations

from s2sad.evaluate.effects import bindings, parameters
from s2sad.tree import (
    AST, Attribute, BinOp, Call, Constant, FunctionDef, List, MatMult, Name,
    Slice, Starred, Store, Subscript, Tuple, UnaryOp, call_name, indices, names,
    stored_names, walk,
)

_SIZED = {f"numpy.{f}" for f in "zeros ones empty full zeros_like ones_like empty_like full_like copy".split()}
_MAKING = _SIZED | {f"numpy.{f}" for f in "array asarray linspace arange eye outer".split()}
_KEEPING = {f"numpy.{f}" for f in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh", "abs", "maximum", "minimum")}


def escaping_lists(function: FunctionDef) -> list[str]:
    """The names of the lists and tuples that escape."""
    written = [(t.id, v) for t, v in _assigned(function) if isinstance(t, Name) and isinstance(v, (List, Tuple))]
    picks = [n for n in walk(function.body) if isinstance(n, Subscript) and isinstance(n.value, Name)]
    if not written or not picks:
        return []
    bound, found = ListBindings(function), []
    stored = {id(n) for p in walk(function.body) if isinstance(p, Subscript) and isinstance(p.ctx, Store)
              for n in _inside(p)}
    for listed, value in written:
        items = value.elts
        own = [p for p in picks if p.value.id == listed and bound.is_variable(p.slice)]
        put = any(p.value.id == listed and isinstance(p.ctx, Store) for p in picks)
        if not own or not items or not bound.is_once(listed) or any(isinstance(i, Starred) for i in items):
            continue
        if isinstance(value, List) and any(id(p) in stored for p in own) or not put and any(
                map(bound.is_array, items)):
            found.append(listed)
    return found


def _assigned(function: FunctionDef) -> list[tuple[AST, AST]]:
    """Targets and their values, those of `a, b = x, y` one by one."""
    found: list[tuple[AST, AST]] = []
    for target, value in bindings(function):
        several = isinstance(target, Tuple) and isinstance(value, Tuple) and len(target.elts) == len(value.elts)
        found += zip(target.elts, value.elts) if several else [(target, value)]
    return found


def has_sizes(item: AST) -> bool:
    """Whether the sizes of what a list begins with are read off its text."""
    method = isinstance(item, Call) and isinstance(item.func, Attribute) and item.func.attr == "copy"
    return isinstance(item, (Name, Constant)) or call_name(item) in _SIZED or method and isinstance(
        item.func.value, Name)


def _inside(place: Subscript) -> list[AST]:
    """A place and the places that it is in: x[i][j], x[i]."""
    return [place, *(_inside(place.value) if isinstance(place.value, Subscript) else [])]


class ListBindings:
    """What the names of a function are bound to."""

    def __init__(self, function: FunctionDef):
        self.values: dict[str, list[AST | None]] = {p: [None] for p in parameters(function)}
        for target, value in _assigned(function):
            for n in stored_names(target):
                self.values.setdefault(n, []).append(value if isinstance(target, Name) else None)
        self.stores = [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]

    def is_once(self, identifier: str) -> bool:
        return self.stores.count(identifier) == 1 == len(self.values[identifier])

    def is_variable(self, place: AST) -> bool:
        """Whether a place in a list is not known to be a written number."""
        if isinstance(place, Slice):
            return False
        for n in names(place):
            value = self.values[n][0] if n in self.values and self.is_once(n) else None
            if "." not in n and (value is None or not isinstance(value, Constant)):
                return True
        return False

    def is_array(self, node: AST, depth: int = 0) -> bool:
        """Whether a value is an array for certain, as far as the text shows it."""
        if isinstance(node, Call):
            method = node.func.attr if isinstance(node.func, Attribute) else ""
            return call_name(node) in _MAKING or method in ("copy", "astype") or call_name(node) in _KEEPING and any(
                self.is_array(a, depth) for a in node.args)
        if isinstance(node, BinOp):
            return not isinstance(node.op, MatMult) and any(self.is_array(s, depth) for s in (node.left, node.right))
        if isinstance(node, UnaryOp):
            return self.is_array(node.operand, depth)
        if isinstance(node, Subscript):
            return any(isinstance(i, Slice) for i in indices(node))
        values = self.values.get(node.id, []) if isinstance(node, Name) and depth < 8 else []
        return any(v is not None and self.is_array(v, depth + 1) for v in values)
