"""passed: what iterations of one nest hand to each other, and to the next nest, without a detour.

An array of the function's own that one nest alone mentions, always at the element of its iteration, is a number there:

    for i in range(n):                  for i in range(n):
        w_bar[i] += g[i]                    w_bar_here = 0.0
        x_bar[i] += a * w_bar[i]            w_bar_here += g[i]
        w_bar[i] = 0.0                      x_bar[i] += a * w_bar_here

and one that a nest fills and the next one empties need not be cleared in between:

    for i in range(n):                  for i in range(n):
        w_bar[i] += g[i]                    w_bar[i] = g[i]
    for i in range(n):                  for i in range(n):
        x_bar[i] += w_bar[i]                x_bar[i] += w_bar[i]
        w_bar[i] = 0.0
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from s2sad.analyze.liveness import base_name
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.bounds import changed, shifted_by
from s2sad.simplify.extents import Extents
from s2sad.simplify.nests import Nest
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, Call, Constant, FunctionDef, If, Name, Sub, Subscript, assign, at, augment,
    call_name, const, copy, dump, indices, name, names, negate, rebuild, walk,
)

_LIKE = {"numpy.empty_like", "numpy.zeros_like"}
_MADE = {"numpy.empty", "numpy.zeros"} | _LIKE


class Passed:
    """The arrays of one function that may be shortened."""

    def __init__(self, function: FunctionDef, extents: Extents, types: Mapping[str, Type], free: Names):
        self.free = free
        self.numbers: dict[str, str] = {}   # the array of which a number is an element
        parameters = {p.id for p in function.args.args}
        self.made = {n.targets[0].id: call_name(n.value) or "" for n in function.body if isinstance(n, Assign)
                     and isinstance(n.targets[0], Name) and call_name(n.value) in _MADE}
        places = Counter(base_name(n) for n in walk(function.body) if isinstance(n, Subscript)
                         and isinstance(n.value, Name))
        mentions = Mentions(function.body)
        self.places = {a: places[a] for a in self.made if a in extents.fixed and a not in parameters and a in types
                       and types[a].dtype == "float64" and mentions.only_places(a, bound=1)}

    def shorten(self, nests: list[Nest], extents: Extents) -> None:
        """Changes the bodies of the nests of one block."""
        using: dict[str, list[Nest]] = {}
        for nest in nests:
            for array in {base_name(n) for n in walk(nest.body) if isinstance(n, Subscript)}:
                using.setdefault(array, []).append(nest)
        for array, total in self.places.items():
            users = [(nest, _places(array, nest.body)) for nest in using.get(array, ())]
            if sum(len(places) for _, places in users) != total or any(
                    len({dump(p.slice) for p in places}) > 1 for _, places in users):
                continue
            if len(users) == 1:
                self.number(array, *users[0])
            elif len(users) == 2 and self.made[array].startswith("numpy.zeros"):
                self.handed(array, users[0][0], users[1][0], extents)

    def is_handed(self, first: list[AST], second: list[AST]) -> bool:
        """Whether one body fills an array of which nothing but the other one reads, at the same element."""
        for array, total in self.places.items():
            given, taken = _places(array, first), _places(array, second)
            if given and taken and len(given) + len(taken) == total and len(
                    {dump(p.slice) for p in (*given, *taken)}) == 1 and _fills(
                    next(s for s in first if _places(array, [s])), array):
                return True
        return False

    def number(self, array: str, nest: Nest, places: list[Subscript]) -> None:
        """An array of one nest as a number."""
        if changed(nest.body) & set(names(places[0].slice)):
            return
        using = [s for s in nest.body if _places(array, [s])]
        body, before = list(nest.body), []
        if not _fills(using[0], array):
            if not self.made[array].startswith("numpy.zeros") or not _clears(using[-1]):
                return
            body = [s for s in body if s is not using[-1]]
            before = [0.0]
        here = self.free.fresh(f"{array}_here")
        self.numbers[here] = array

        def change(node: AST) -> AST | None:
            return name(here) if isinstance(node, Subscript) and base_name(node) == array else None
        nest.body = [at(assign(here, const(v)), using[0]) for v in before] + [
            _bound(rebuild(s, change)) if any(s is u for u in using) else s for s in body]

    def handed(self, array: str, first: Nest, second: Nest, extents: Extents) -> None:
        """An array that the first nest fills and the second one empties."""
        fills = next(s for s in first.body if _places(array, [s]))
        clears = [s for s in second.body if _places(array, [s])][-1]
        if not isinstance(fills, AugAssign) or not _clears(clears) or _places(array, [fills.value]) or not (
                isinstance(fills.target, Subscript)) or _region(array, first) is None:
            return
        if _region(array, first) != _region(array, second) or list(map(extents.reduced, first.runs)) != list(
                map(extents.reduced, second.runs)):
            return
        value = negate(copy(fills.value)) if isinstance(fills.op, Sub) else copy(fills.value)
        first.body = [at(assign(copy(fills.target), value), s) if s is fills else s for s in first.body]
        second.body = [s for s in second.body if s is not clears]


def _places(array: str, body: list[AST]) -> list[Subscript]:
    return [n for n in walk(body) if isinstance(n, Subscript) and base_name(n) == array]


def _fills(statement: AST, array: str) -> bool:
    """Whether a statement stores into the array and does not read it."""
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Subscript) and base_name(
        statement.targets[0]) == array and not _places(array, [statement.value])


def _clears(statement: AST) -> bool:
    """Whether a statement stores zero."""
    return isinstance(statement, Assign) and isinstance(statement.targets[0], Subscript) and isinstance(
        statement.value, Constant) and type(statement.value.value) is float and statement.value.value == 0.0


def _region(array: str, nest: Nest) -> list[tuple[int, int]] | None:
    """For every axis the loop that walks it and where that begins; None if a subscript is no counter of its own."""
    found: list[tuple[int, int]] = []
    for subscript in indices(_places(array, nest.body)[0]):
        walked = [(k, shift + nest.starts[k].constant) for k, counter in enumerate(nest.counters)
                  if (shift := shifted_by(subscript, counter)) is not None]
        found += walked
        if not walked:
            return None
    return found if sorted(k for k, _ in found) == list(range(len(nest.counters))) else None


def _bound(statement: AST) -> AST:
    """The statement with a name bound where an element was stored."""
    if isinstance(statement, If):
        return with_blocks(statement, lambda block: list(map(_bound, block)))
    if isinstance(statement, AugAssign) and isinstance(statement.target, Name):
        return at(augment(statement.target.id, statement.op, statement.value), statement)
    if isinstance(statement, Assign) and isinstance(statement.targets[0], Name):
        return at(assign(statement.targets[0].id, statement.value), statement)
    return statement


class Mentions:
    """How often each name is mentioned in a body, and how often as an array of which an element or the shape is
    meant."""

    def __init__(self, body: list[AST]):
        self.names: Counter[str] = Counter()
        self.places: Counter[str] = Counter()
        for node in walk(body):
            if isinstance(node, Name):
                self.names[node.id] += 1
            elif isinstance(node, (Subscript, Attribute)) or isinstance(node, Call) and call_name(node) in _LIKE:
                holder = node.args[0] if isinstance(node, Call) else node.value
                self.places[holder.id if isinstance(holder, Name) else ""] += 1

    def only_places(self, array: str, bound: int = 0) -> bool:
        """Whether an array is mentioned by its elements and its shape only, but for so many times where it is bound."""
        return self.places[array] + bound == self.names[array]


__all__ = ["Mentions", "Passed"]
