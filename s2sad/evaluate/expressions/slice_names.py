"""slice_names: names of slices stand for the slices.

    def f(u: float64[:, :], v: float64[:, :], m: int64):    def f(u, v, m):
        every = np.s_[::2]                                      part_start = m
        part = slice(m, -1)                                     m += 1
        m += 1                                                  v[part_start:-1, ::2] = u[part_start:-1, ::2]
        v[part, every] = u[part, every]                         v[m] = 0.0
        v[m] = 0.0

*Requires* resolved names. *Establishes* that slices stand in subscripts alone; one that is no subscript is refused.
What a slice is made of is what it is where the slice is made: it has a name if it may be something else where the slice
is used.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from s2sad.evaluate.effects import STABLE
from s2sad.evaluate.scope import KernelScope
from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Call, Constant, FunctionDef, Name, Slice, Store, Subscript, Tuple, UnaryOp, assign,
    at, call_name, children, copy, expr, head_copy, name, names, rebuild, stored_names, tuple_of, walk, with_body,
)

_SLICE, _WRITTEN = "builtins.slice", "numpy.s_"
_NUMBERS = {"builtins.len": 1, "builtins.int": 1, "builtins.abs": 1, "builtins.min": 2, "builtins.max": 2}
_GROWING = ("append", "extend", "insert", "pop", "remove", "clear")
_BOUNDS = ("start", "stop", "step")
_WHERE_USED = "write the slice where it is used: x[a:b]"


def slice_names(function: FunctionDef, scope: KernelScope) -> FunctionDef:
    """The function without names of slices."""
    if not any(isinstance(n, Name) and n.id in (_SLICE, _WRITTEN) for n in walk(function.body)):
        return function
    function = copy(function)
    function.body = _separate(function.body)
    known: dict[str, AST] = {}
    function.body = _Made(function, scope, known).block(function.body)
    new = with_body(function, _block(function.body, known))
    for node in walk(new.body):
        if call_name(node) == _SLICE or isinstance(node, Name) and node.id in known:
            scope.refuse(node, "a slice that is no subscript", help=_WHERE_USED)
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


class _Made:
    """The slices of one function that have names, with what they are made of; `known` is filled."""

    def __init__(self, function: FunctionDef, scope: KernelScope, known: dict[str, AST]):
        self.scope, self.known = scope, known
        found = [n for n in walk(function.body) if isinstance(n, Name)]
        self.grown = _grown(function.body)
        self.stores = Counter(n.id for n in found if isinstance(n.ctx, Store))
        self.reads = Counter(n.id for n in found if not isinstance(n.ctx, Store))
        first = {n.id: n for n in reversed(found)}
        self.read_before = {n for n, node in first.items() if not isinstance(node.ctx, Store)}

    def block(self, block: list[AST]) -> list[AST]:
        made: list[AST] = []
        for position, statement in enumerate(block):
            for field in ("body", "orelse"):
                if hasattr(statement, field):
                    setattr(statement, field, self.block(getattr(statement, field)))
            target = statement.targets[0] if isinstance(statement, Assign) and len(statement.targets) == 1 else None
            if isinstance(target, Name) and (found := _spelled(statement.value, self.known)) is not None:
                if self.stores[target.id] > 1 or target.id in self.read_before:
                    self.scope.refuse(statement, "a slice whose name changes, or is read before", help=_WHERE_USED)
                before, self.known[target.id] = self.kept(target.id, found, block[position + 1:])
                made += [at(s, statement) for s in before]
            made.append(statement)
        return made

    def kept(self, identifier: str, found: AST, rest: list[AST]) -> tuple[list[AST], AST]:
        """The slice with names for what may change before its last use, which the statements before it bind."""
        uses = sum(isinstance(n, Name) and n.id == identifier for n in walk(rest))
        alone = uses == self.reads[identifier]
        stored = {*stored_names(rest), *_grown(rest)} if alone else {*self.stores, *self.grown}
        before: list[AST] = []

        def stays(part: AST, number: bool) -> bool:
            fixed = _is_number(part) if number else isinstance(part, (Name, Constant))
            return fixed and not stored & set(names(part))

        def held(part: AST | None, wanted: str, number: bool) -> AST | None:
            if part is None or stays(part, number):
                return part
            before.append(assign(new := self.scope.fresh(f"{identifier}_{wanted}"), part))
            return name(new)

        def changed(node: AST, wanted: str) -> AST | None:
            if isinstance(node, Tuple):
                return at(tuple_of(*(changed(e, str(k)) for k, e in enumerate(node.elts))), node)
            if not isinstance(node, Slice):
                return held(node, wanted, False)
            return Slice(*(held(p, w, True) for p, w in zip((node.lower, node.upper, node.step), _BOUNDS)))
        return before, changed(found, "place")


def _grown(block: list[AST]) -> set[str]:
    """The names whose lengths methods may change: those of lists that grow."""
    return {n.func.value.id for n in walk(block) if isinstance(n, Call) and isinstance(n.func, Attribute)
            and isinstance(n.func.value, Name) and n.func.attr in _GROWING}


def _is_number(part: AST) -> bool:
    """Whether a bound of a slice is made of nothing but numbers and sizes: stores into arrays cannot change it."""
    if isinstance(part, Attribute):
        return part.attr in STABLE and isinstance(part.value, Name)
    if isinstance(part, Subscript):
        return isinstance(part.value, Attribute) and _is_number(part.value) and isinstance(part.slice, (
            Constant, UnaryOp)) and _is_number(part.slice)
    if isinstance(part, Call):
        plain = len(part.args) >= _NUMBERS.get(call_name(part) or "", 9) and not part.keywords
        return plain and all(map(_is_number, part.args))
    return isinstance(part, (Name, Constant)) or isinstance(part, (BinOp, UnaryOp)) and all(
        _is_number(c) for c in children(part) if isinstance(c, expr))


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
        new = head_copy(statement)
        for field in statement._fields:
            inner = getattr(statement, field)
            setattr(new, field, _block(inner, known) if field in ("body", "orelse") else rebuild(inner, change))
        made.append(new)
    return made
