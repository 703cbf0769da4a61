"""escaping_lists: lists that a kernel spells out and that become arrays, as lists that grow do.

    m = [np.zeros_like(x), x.copy()]                m = builtins.list(2)
    for t in range(n):                              m[0] = np.zeros_like(x)
        m[t % 2][:] = m[(t + 1) % 2] + x            m[1] = x.copy()
                                                    ...

One escapes if it holds arrays of which a variable picks one, or numbers of which a variable tells which is stored into.
A list whose elements are all picked by constants, or by the counter of a loop that is unrolled, needs no array: its
elements are names, and may have different shapes. A list that repeats a number becomes a comprehension, and one that
repeats None a list that is yet to be filled:

    z = [0.0] * n                                   z = [0.0 for each in range(n)]
    t = [[0.0] * n for i in range(m)]               t = [[0.0 for each in range(n)] for i in range(m)]
    gains = [None] * n                              gains = builtins.list(n)

Requires resolved names.
"""
from __future__ import annotations

from s2sad.evaluate.effects import bindings, parameters
from s2sad.evaluate.loops.literal_sequences import literal
from s2sad.evaluate.scope import KernelScope
from s2sad.infer.call_types import LISTED
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Call, Compare, Constant, For, FunctionDef, List, ListComp, MatMult, Mult, Name,
    Slice, Starred, Store, Subscript, Tuple, UnaryOp, at, call, call_name, const, copy, expression, indices, names,
    rebuild, rename, stored_names, walk, walk_statements,
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
        loops = [s for s in walk_statements(function.body) if isinstance(s, For)]
        rounds = [n for s in loops if self.is_written(s.iter) for n in stored_names(s.target)]
        self.rounds = {n for n in rounds if rounds.count(n) == self.stores.count(n)}

    def is_once(self, identifier: str) -> bool:
        return self.stores.count(identifier) == 1 == len(self.values[identifier])

    def is_written(self, iterable: AST) -> bool:
        """Whether a loop goes through items that are spelled out, so that it may be written out."""
        if isinstance(iterable, Name) and len(self.values.get(iterable.id, [])) == 1 and (
                value := self.values[iterable.id][0]) is not None:
            iterable = value
        return literal(iterable) is not None

    def is_variable(self, place: AST) -> bool:
        """Whether a place in a list is not known to be a written number."""
        if isinstance(place, Slice):
            return False
        for n in names(place):
            value = self.values[n][0] if n in self.values and self.is_once(n) else None
            if "." not in n and n not in self.rounds and (value is None or not isinstance(value, Constant)):
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


def list_repetition(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function in which lists that repeat an item are comprehensions, or yet to be filled; a constant number of
    elements stays what it is, unless a variable tells which one is stored into."""
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
