"""What loops go through: items as a loop comes to them, in the order and at the time that Python reads them.
"""
from __future__ import annotations

from collections.abc import Hashable, Sequence
from enum import Enum
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.classes.enumerations import all_members
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.sequences.cursors import TOGETHER
from s2sad.evaluate.specialize.sequences.endless import ENDLESS, is_endless
from s2sad.evaluate.specialize.sequences.gathering import Gathered
from s2sad.evaluate.specialize.sequences.generators import LAZY
from s2sad.evaluate.specialize.sequences.nested_ranges import NESTED
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    FACTORY, LARGEST_SEQUENCE, UNKNOWN, ClassValue, Data, Iteration, MethodValue, Reference, ResidualObject,
    TupleValue, Value, constant, value_of_key,
)
from s2sad.tree import AST


@operation
def list_of(ev: Evaluator, items: Sequence[Value], origin: AST) -> Value:
    """A new list; of a site whose lists are residual, one of the residual program."""
    if id(origin) in ev.sites:
        if any(isinstance(i, Data) and isinstance(i.known, bool) for i in items):
            raise ev.refusal(origin, "a list of bools, of which a variable picks", help="make it an array")
        rows = ev.listed_records(origin)
        made = tree.at(tree.List([ev.spelled_item(ev.as_row(rows, i, origin), origin) for i in items], tree.Load()),
                       origin)
        wanted, statement = ev.wanted.get(origin, ("items", origin))
        return ev.named(Data(made, is_list=True, rows=rows), wanted, statement)
    count = ev.counted(items, origin)
    held: dict[Hashable, Value] = {k: ev.atoms(v, "item", origin) for k, v in enumerate(items)}
    return ev.heap.new(Object("list", held, site=origin, count=count))


@operation
def counted(ev: Evaluator, items: Sequence[Value], origin: AST, times: int = 1) -> int:
    """How many values a sequence of these items, so many times, has in it; refuses a large one before it is made."""
    count = times * sum(i.count if isinstance(i, TupleValue) else ev.heap[i].count if isinstance(i, Reference) else 1
                        for i in items)
    if count > LARGEST_SEQUENCE:
        raise ev.refusal(origin, f"a tuple or list of more than {LARGEST_SEQUENCE} items",
                         help="allocate an array before and fill it in a for loop")
    return count


@operation
def items_of(ev: Evaluator, value: Value, node: AST, f: Frame) -> list[Value]:
    """All items that a value gives when it is gone through; raises Unevaluated."""
    ev.used(value, node)
    return all_items(ev, value, node, f)


@operation
def all_items(ev: Evaluator, value: Value, node: AST, f: Frame) -> list[Value]:
    """The same of what is marked as used."""
    if is_endless(value):
        raise ev.unknown(node, "an iterator that never ends, of which all items are asked for", help=(
            "go through it beside what ends, as in zip(x, itertools.count()), or take some: itertools.islice(it, n)"))
    if ev.is_attribute_dictionary(value):
        value = ev.attributes_now(value, node)
    if isinstance(value, TupleValue):
        own = ev.special_method(value, "__iter__", node, f)
        return list(value.items) if own is None else items_of(ev, ev.call(own, [], {}, node, f), node, f)
    if is_sparse(value, ev.heap):
        ev.refuse_whole(value, node)
    if isinstance(value, Reference):
        held = ev.heap[value]
        if held.kind == "list":
            return list(held.items.values())
        if held.kind == "dict":
            return _views(ev, value, "keys")
        if held.kind == "set":
            return list(held.items.values())
        if held.kind == "iterator":
            return all_items(ev, ev.rest_of(value, node, f), node, f)
        return _of_object(ev, value, node, f)
    if isinstance(value, Data) and isinstance(value.known, str):
        return [constant(c) for c in value.known]
    if isinstance(value, ClassValue):
        return _members(ev, value, node)
    if isinstance(value, ResidualObject) and value.table.kind == "list":
        return [ev.residual_item(value, k, node) for k in value.table.columns]
    if isinstance(value, ResidualObject) and value.table.kind == "dict":
        return [value_of_key(k) for k in value.table.columns]
    if isinstance(value, ResidualObject):
        return _of_object(ev, value, node, f)
    if not isinstance(value, Iteration):
        return _of_data(ev, value, node)
    if value.kind == "range":
        span = range(*(ev.known(p, node, "how often a loop runs, of which each round is written out,")
                       for p in value.parts))
        if len(span) > LARGEST_SEQUENCE:
            raise ev.refusal(node, f"a range of more than {LARGEST_SEQUENCE} numbers, each of which must be known "
                             "before the run", help="let it run over arrays")
        return [constant(k) for k in span]
    if value.kind in ("keys", "values", "items"):
        return _views(ev, value.parts[0], value.kind)
    if value.kind == "reversed":
        items = _backwards(ev, value.parts[0], node, f)
        return items if value.more is None else items[len(items) - value.more:] if value.more <= len(items) else []
    if value.kind in LAZY:
        gathered = Gathered(ev, f, node)
        ev.each_item(value, node, f, gathered.add)
        return list(gathered.done())
    if value.kind in NESTED:
        return ev.nested_items(value, node, f)
    if value.kind == "part":
        raise ev.unknown(node, "how many items there are must be known before the run")
    if value.kind == "filter":
        return _filtered(ev, value, node, f)
    if value.kind == "itertools.pairwise":
        items = all_items(ev, value.parts[0], node, f)
        return [TupleValue(pair) for pair in zip(items, items[1:])]
    assert value.kind in TOGETHER
    gathered, cursor = Gathered(ev, f, node), ev.cursor_of(value, node, f)
    while (step := cursor.next()) is not None:
        gathered.add(step[0])
        cursor = step[1]
    return list(gathered.done())


def _backwards(ev: Evaluator, value: Value, node: AST, f: Frame) -> list[Value]:
    """The items from the last one on, as a class of the user's says what they are."""
    own = ev.special_method(value, "__reversed__", node, f)
    if own is not None:
        return items_of(ev, ev.call(own, [], {}, node, f), node, f)
    if isinstance(value, TupleValue) or isinstance(value, Reference) and ev.heap[value].kind == "record":
        size = ev.known(length(ev, value, node, f), node, "how many items there are")
        return [ev.item_of(value, constant(k), node, f) for k in reversed(range(size))]
    return all_items(ev, value, node, f)[::-1]


def _views(ev: Evaluator, base: Any, kind: str) -> list[Value]:
    items = {k: v for k, v in ev.heap[base].items.items() if k is not FACTORY}
    if kind == "keys":
        return [value_of_key(k) for k in items]
    return list(items.values()) if kind == "values" else [TupleValue((value_of_key(k), v)) for k, v in items.items()]


def _members(ev: Evaluator, value: ClassValue, node: AST) -> list[Value]:
    """The members of an enumeration."""

    if isinstance(value.live, type) and issubclass(value.live, Enum):
        return all_members(ev, value.live)
    raise ev.refusal(node, f"the class '{value.name}' is gone through")


def _of_data(ev: Evaluator, value: Value, node: AST) -> list[Value]:
    """The elements of an array, where their number is known."""
    if isinstance(value, Data) and isinstance(value.known, tuple):
        return [Data(tree.at(tree.index(ev.spelled(value, node), tree.const(k)), node), known)
                for k, known in enumerate(value.known)]
    if isinstance(value, Data) and value.count is not None:
        return [Data(tree.at(tree.index(ev.spelled(value, node), tree.const(k)), node), demands=value.demands, shape=())
                for k in range(value.count)]
    shape = shape_of(ev, value)
    if isinstance(value, Data) and shape.is_known and shape.known:
        return [Data(tree.at(tree.index(ev.spelled(value, node), tree.const(k)), node), shape=tuple(shape.known[1:]))
                for k in range(shape.known[0])]
    listed = isinstance(value, Data) and value.is_list
    tells = shape if shape.demands else value           # a text has no shape
    raise ev.unknown(node, "how many items there are must be known before the run", tells, help=(
        "go through it in a for loop whose body binds numbers and arrays alone" if listed else ""))


@operation
def shape_of(ev: Evaluator, value: Value) -> Data:
    """What is known of an array's shape, as the constant that it is or with what would make it known."""
    if not isinstance(value, Data):
        return Data(tree.const(None))
    found = value.shape
    if found is not None and None not in found:
        return Data(tree.const(None), found)
    demands = {(path, "shape") for path in value.origins}
    return Data(tree.const(None), demands=frozenset(demands - ev.facts.keys()))


def _filtered(ev: Evaluator, value: Iteration, node: AST, f: Frame) -> list[Value]:
    found = []
    for item in all_items(ev, value.parts[1], node, f):
        plain = isinstance(value.parts[0], Data) and value.parts[0].known is None
        kept = ev.truth(item if plain else ev.call(value.parts[0], [item], {}, node, f), node, f)
        if isinstance(kept, Data):
            raise ev.unknown(node, "which items pass a filter must be known before the run", kept)
        if kept:
            found.append(item)
    return found


def _of_object(ev: Evaluator, value: Reference | ResidualObject, node: AST, f: Frame) -> list[Value]:
    """An object of a class with `__iter__`."""
    made = ev.class_of(value)
    own = ev.method_named(made, "__iter__", value, node, f)
    if own is None:
        title = made.name if made else "?"
        raise ev.refusal(node, f"an object of class {title} is gone through, which has no __iter__",
                         help="loop over what it holds")
    through = ev.call(own, [], {}, node, f)
    if through == value:
        raise ev.refusal(node, f"an object of class {made.name if made else '?'} says itself what comes next, by "
                         "__next__", help="write __iter__ as a generator: yield each")
    return items_of(ev, through, node, f)


@operation
def stays_one(ev: Evaluator, value: Value) -> bool:
    """Whether a loop goes through numbers and arrays alone, so that it may stay a loop."""
    if isinstance(value, Iteration):
        if value.kind in ("range", "part", *ENDLESS):
            return True
        inner = value.parts[:1] if value.kind == "enumerate" else value.parts
        return value.kind in ("zip", "enumerate", "reversed") and all(stays_one(ev, p) for p in inner)
    flat = isinstance(value, MethodValue) and value.name == "flat"
    return flat or isinstance(value, Data) and not isinstance(value.known, str)


@operation
def length(ev: Evaluator, value: Value, node: AST, f: Frame) -> Value:
    """`len(value)`."""
    if isinstance(value, Data):
        if isinstance(value.known, (str, tuple)):
            return constant(len(value.known))
        if value.count is not None:
            return constant(value.count)
        shape = shape_of(ev, value)
        return Data(tree.at(tree.call("len", ev.spelled(value, node)), node),
                    shape.known[0] if shape.is_known and shape.known else UNKNOWN, shape.demands)
    own = ev.special_method(value, "__len__", node, f)
    if own is not None:
        return ev.call(own, [], {}, node, f)
    if isinstance(value, ResidualObject) and value.table.kind != "record":
        return constant(len(value.table.columns))
    if isinstance(value, ResidualObject) or isinstance(value, Reference) and ev.heap[value].kind == "record":
        raise ev.refusal(node, f"len() of {ev.kind_of(value)}, whose class has no __len__")
    if isinstance(value, TupleValue):
        return constant(len(value.items))
    return constant(len(items_of(ev, value, node, f)))
