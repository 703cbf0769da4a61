"""Iterators: each is gone through once, and not further than it is asked.

    if any(f(x, k) for k in range(n)):         for k in range(n):
                                         ->        if f(x, k): found = True; break
"""
from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import Leave
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.gathering import frame_inside, loops_of, own_loops
from s2sad.evaluate.specialize.sequences.generators import ITEM, LAZY
from s2sad.evaluate.specialize.sequences.endless import TAKEN, is_endless
from s2sad.evaluate.specialize.values import NONE, Data, Iteration, Reference, TupleValue, Value, alike, constant
from s2sad.tree import AST

_TWICE = (      # of an iterator that ends, and of one that never does: what is said, and the help
    ("an iterator is gone through twice, and has no items the second time", "make it a list: list(...)"),
    ("an iterator that never ends is gone through twice, and goes on where it was left", "make another one"))
_BEGUN = ("a generator goes on behind the item that next() has taken", "go through it in one loop, or make it a list "
          "first, items = list(...), and pick by an index")
STARTED, ITERATED, DEFAULT, TOTAL = ".started", ".iterated", ".default", ".total"
BEGUN = "begun"     # by next(), in place of True


@operation
def iterator(ev: Evaluator, kind: str, *items: Value, more: Any = None, first: Value | None = None) -> Iteration:
    """An iterator; the heap knows whether it is used up, and what the first loop of a generator goes through."""
    held: dict[Hashable, Value] = {STARTED: constant(False)}
    if first is not None:
        held[ITERATED] = first
    return Iteration(kind, items, more, ev.heap.new(Object("iterator", held)))


@operation
def first_of(ev: Evaluator, value: Iteration) -> Value:
    """What the first loop of a generator's expression goes through."""
    assert value.once is not None
    return ev.heap[value.once].items[ITERATED]


@operation
def used(ev: Evaluator, value: Value, node: AST) -> None:
    """Something is gone through, with what it goes through itself."""
    if not isinstance(value, Iteration):
        return
    if value.once is not None:
        started = ev.heap[value.once].items[STARTED]
        if not (isinstance(started, Data) and started.known is False):
            begun = isinstance(started, Data) and started.known == BEGUN
            raise ev.refusal(node, *(_BEGUN if begun else _TWICE[is_endless(value)]))
        ev.heap.put(value.once, STARTED, constant(True))
    for part in value.parts:
        used(ev, part, node)


@operation
def next_endless(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> Value:
    """The next item, which is taken."""
    assert value.once is not None
    held = ev.heap[value.once].items
    started = held[STARTED]
    if not (isinstance(started, Data) and started.known is False):
        raise ev.refusal(node, "an iterator is asked that something has gone through", help="make another one")
    found = ev.item_at(value, constant(0), node, f)
    more = ev.binary(tree.Add(), held[TAKEN], constant(1), node, f)
    ev.heap.put(value.once, TAKEN, ev.atoms(more, "taken", node))
    return found


@operation
def is_iterator(ev: Evaluator, value: Value) -> bool:
    """Whether a value is an iterator, whose items are computed when they are asked for."""
    if isinstance(value, Reference):
        return ev.heap[value].kind == "iterator"
    return isinstance(value, Iteration) and value.once is not None and not is_read_in_place(ev, value)


@operation
def is_read_in_place(ev: Evaluator, value: Value) -> bool:
    """Whether the items of what is gone through are there, and read as they are when their turn comes."""
    if isinstance(value, Iteration):
        plain = value.kind in ("zip", "enumerate", "reversed", "range", "keys", "values", "items")
        return plain and all(isinstance(p, Data) or is_read_in_place(ev, p) for p in value.parts)
    return isinstance(value, TupleValue) and value.made is None or isinstance(value, Reference) and ev.heap[
        value].kind in ("list", "dict", "set")


@operation
def refuse_changed(ev: Evaluator, items: TupleValue, source: Value, node: AST) -> None:
    """Refuses the items of a list that holds others by now: Python reads each when its turn comes."""
    if not isinstance(source, Reference) or ev.heap[source].kind != "list":
        return
    found = [*ev.heap[source].items.values()]
    if len(found) != len(items.items) or not all(map(alike, found, items.items)):
        raise ev.refusal(node, "a list that changes while itertools.cycle goes through it",
                         help="give it a copy: itertools.cycle(tuple(...))")


@operation
def tests_of(ev: Evaluator, through: Value, stops: bool, node: AST, f: Frame) -> list[bool | Data] | None:
    """Whether each item is true, up to the first that decides; None where that takes statements or changes what an
    object holds, of which Python does no more than it needs to: go back, then."""
    found: list[bool | Data] = []
    if isinstance(through, Iteration):
        if through.kind in LAZY and through.kind != "generator":
            return None
        used(ev, through, node)
    before = ev.snapshot()
    try:
        _find_tests(ev, through, stops, found, node, f)
    except Leave:       # raised by what Python may not come to
        return None
    return None if ev.has_acted(before) else found


def _find_tests(ev: Evaluator, through: Value, stops: bool, found: list[bool | Data], node: AST, f: Frame) -> None:
    if isinstance(through, Iteration) and through.kind == "generator":
        comprehension, frame = through.more
        ev.generate(comprehension.generators, frame, lambda g: found.append(
            stops if stops in found else ev.test_of(comprehension.elt, g)), first_of(ev, through))
        return
    cursor = ev.cursor_of(through, node, f)
    while stops not in found and (step := cursor.next()) is not None:
        item, cursor = step
        found.append(ev.truth(item, node, f))


@operation
def first_item(ev: Evaluator, through: Value, node: AST, f: Frame, body: Callable[[AST], AST], end: AST,
               default: Value = NONE) -> Value:
    """What the statement returns that is done with each item; where it never returns, what `end` does, which may read
    DEFAULT."""
    if isinstance(through, Iteration) and through.kind == "generator":
        used(ev, replace(through, parts=()), node)
        comprehension, outer = through.more
        inner = frame_inside(ev, outer, comprehension, DEFAULT, ITEM)
        ev.heap.put(inner.reference, ITERATED, first_of(ev, through))
        loops = loops_of(ev, comprehension, ("first", id(node)), lambda: [
            tree.assign(ITEM, comprehension.elt), body(tree.name(ITEM))])
    else:
        inner = replace(f, reference=ev.heap.new(Object("frame", {ITERATED: through})), outer=f, is_entry=False,
                        local=frozenset({ITEM, ITERATED, DEFAULT}), nonlocals=frozenset())
        loops = ev.loops_of.get((node, "first")) or tree.at(tree.For(
            tree._target(tree.name(ITEM)), tree.name(ITERATED), [body(tree.name(ITEM))], [], None), node)
        ev.loops_of[node, "first"] = loops
    ev.heap.put(inner.reference, DEFAULT, default)
    depth = len(ev.pending)
    inner = replace(inner, mark=depth, loops=len(ev.loops), yields=None)
    ev.pending.append(None)
    try:
        ev.statements([loops, tree.at(end, node)], inner)
        raise AssertionError("what follows a return")
    except Leave as leave:
        if leave.mark != depth:
            raise
        assert leave.value is not None
        return leave.value
    finally:
        del ev.pending[depth:]
        del ev.loops[inner.loops:]


@operation
def total_of(ev: Evaluator, through: Iteration, start: Value, node: AST) -> Value:
    """The sum of what a generator gives, whose loops add to it."""
    used(ev, replace(through, parts=()), node)
    comprehension, outer = through.more
    inner = frame_inside(ev, outer, comprehension, TOTAL)
    ev.heap.set_items(inner.reference, {ITERATED: first_of(ev, through), TOTAL: ev.atoms(start, "total", node)})
    with own_loops(ev):
        ev.statements([loops_of(ev, comprehension, "total", lambda: [
            tree.augment(TOTAL, tree.Add(), comprehension.elt)])], inner)
    return ev.heap.objects.pop(inner.reference.number).items[TOTAL]
