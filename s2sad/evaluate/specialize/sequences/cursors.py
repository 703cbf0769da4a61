"""Where a loop is: going on gives another cursor, so that ways that part go on apart.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.sequences.endless import ENDLESS, OfEndless, is_endless
from s2sad.evaluate.specialize.values import (
    FACTORY, Data, Iteration, Reference, TupleValue, Value, constant, value_of_key,
)
from s2sad.tree import AST


@dataclass(frozen=True)
class Known:
    """Items that are known beforehand."""
    items: tuple[Value, ...]
    k: int = 0

    def next(self) -> tuple[Value, Known] | None:
        return (self.items[self.k], Known(self.items, self.k + 1)) if self.k < len(self.items) else None


@dataclass(frozen=True)
class OfList:
    """The items of a list that are there when their round comes."""
    ev: Evaluator
    base: Reference
    k: int = 0

    def next(self) -> tuple[Value, OfList] | None:
        items = self.ev.heap[self.base].items
        return (items[self.k], OfList(self.ev, self.base, self.k + 1)) if self.k < len(items) else None


@dataclass(frozen=True)
class Backwards:
    """The items of a list from the last one on."""
    ev: Evaluator
    base: Reference
    k: int

    def next(self) -> tuple[Value, Backwards] | None:
        items = self.ev.heap[self.base].items
        return (items[self.k], Backwards(self.ev, self.base, self.k - 1)) if 0 <= self.k < len(items) else None


@dataclass(frozen=True)
class OfDict:
    """The keys, values or items of a dict: values as they are when their round comes."""
    ev: Evaluator
    base: Reference
    kind: str
    keys: tuple[Any, ...]
    k: int = 0

    def next(self) -> tuple[Value, OfDict] | None:
        if self.k == len(self.keys):
            return None
        held, key = self.ev.heap[self.base], self.keys[self.k]
        if tuple(_keys(self.ev, self.base)) != self.keys:
            raise self.ev.refusal(held.site, f"'{held.label or 'a dict'}' gets or loses keys while a loop goes through "
                                  "it", help="loop over list(...) of it")
        name, value = value_of_key(key), held.items[key]
        item = name if self.kind == "keys" else value if self.kind == "values" else TupleValue((name, value))
        return item, OfDict(self.ev, self.base, self.kind, self.keys, self.k + 1)


def _keys(ev: Evaluator, base: Reference) -> list[Any]:
    return [k for k in ev.heap[base].items if k is not FACTORY]


@dataclass(frozen=True)
class Together:
    """Several at once: zip, enumerate, map."""
    cursors: tuple[Any, ...]
    made: Callable[[tuple[Value, ...]], Value]

    def next(self) -> tuple[Value, Together] | None:
        items, cursors = [], []
        for cursor in self.cursors:
            found = cursor.next()
            if found is None:
                return None
            items.append(found[0])
            cursors.append(found[1])
        return self.made(tuple(items)), Together(tuple(cursors), self.made)


@dataclass(frozen=True)
class OfArray:
    """The elements of an array of whose length the run makes sure."""
    ev: Evaluator
    base: Data
    node: AST
    k: int = 0

    def next(self) -> tuple[Value, OfArray]:
        item = Data(tree.at(tree.index(self.ev.spelled(self.base, self.node), tree.const(self.k)), self.node),
                    shape=self.base.shape[1:] if self.base.shape else None, origins=self.base.origins)
        return item, OfArray(self.ev, self.base, self.node, self.k + 1)


def _zipped(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> Any:
    """Several at once; arrays of unknown length are taken to be as long as a list beside them, which a guard checks."""
    lengths = [len(ev.heap[p].items) for p in value.parts if isinstance(p, Reference) and ev.heap[p].kind == "list"]
    lengths += [len(p.items) for p in value.parts if isinstance(p, TupleValue)]
    cursors = []
    for part in value.parts:
        shape = ev.shape_of(part)
        told = isinstance(part, Data) and (part.is_list or part.is_known or shape.is_known or bool(shape.demands))
        if lengths and isinstance(part, Data) and not told:
            test = tree.compare(tree.call("len", ev.spelled(part, node)), tree.GtE(), tree.const(min(lengths)))
            why = tree.const("an array has fewer items than the list that it is zipped with")
            ev.emit(tree.Assert(test, why), node)
            cursors.append(OfArray(ev, part, node))
        else:
            cursors.append(_beside(ev, part, node, f))
    return Together(tuple(cursors), TupleValue)


@operation
def cursor_of(ev: Evaluator, value: Value, node: AST, f: Frame) -> Any:
    """The start of a loop through a value; raises Unevaluated where the rounds are not known."""
    if isinstance(value, Reference) and ev.heap[value].kind == "list":
        return OfList(ev, value)
    if isinstance(value, Reference) and ev.heap[value].kind == "dict":
        return OfDict(ev, value, "keys", tuple(_keys(ev, value)))
    if isinstance(value, Iteration) and value.kind in ("keys", "values", "items"):
        base = value.parts[0]
        assert isinstance(base, Reference)
        return OfDict(ev, base, value.kind, tuple(_keys(ev, base)))
    if isinstance(value, Iteration) and value.kind == "reversed" and isinstance(value.parts[0], Reference) and (
            ev.heap[value.parts[0]].kind == "list"):
        return Backwards(ev, value.parts[0], value.more - 1)
    if isinstance(value, Iteration) and not is_endless(value):
        inner = _CURSORS.get(value.kind)
        if inner is not None:
            return inner(ev, value, node, f)
    return Known(tuple(ev.all_items(value, node, f)))


def _beside(ev: Evaluator, value: Value, node: AST, f: Frame) -> Any:
    """The start of a loop through a value beside others, which may end first."""
    if isinstance(value, Iteration) and value.kind in ENDLESS:
        return OfEndless(ev, value, node, f)
    if isinstance(value, Iteration) and is_endless(value):
        return _CURSORS[value.kind](ev, value, node, f)
    return cursor_of(ev, value, node, f)


def _enumerated(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> Any:
    first = ev.known(value.parts[1], node, "the start of enumerate") if value.parts[1:] else 0

    @dataclass(frozen=True)
    class Count:
        k: int

        def next(self) -> tuple[Value, Count]:
            return constant(self.k), Count(self.k + 1)
    return Together((Count(first), _beside(ev, value.parts[0], node, f)), TupleValue)


def _mapped(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> Any:
    function, *through = value.parts
    return Together(tuple(_beside(ev, p, node, f) for p in through),
                    lambda items: ev.call(function, list(items), {}, node, f))


def _behind(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> Any:
    """Behind so many items."""
    base, k = value.parts
    cursor = _beside(ev, base, node, f)
    for _ in range(ev.known(k, node, "how many items were taken")):
        found = cursor.next()
        cursor = found[1] if found is not None else Known(())
    return cursor


@operation
def item_behind(ev: Evaluator, base: Value, k: int, node: AST, f: Frame) -> list[Value]:
    """The item behind k others of what is read in place; none where there is none."""
    found = _behind(ev, Iteration("behind", (base, constant(k))), node, f).next()
    return [] if found is None else [found[0]]


_CURSORS: dict[str, Callable[..., Any]] = {
    "zip": _zipped, "enumerate": _enumerated, "map": _mapped, "behind": _behind}
TOGETHER = tuple(_CURSORS)
