"""Methods of lists, dicts and sets.
"""
from __future__ import annotations

import collections
from collections.abc import Callable, Hashable, Sequence
from typing import Any

from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    FACTORY, NONE, ClassValue, Data, Iteration, MethodValue, OpaqueValue, Reference, ResidualObject, TupleValue, Value,
    constant,
)
from s2sad.tree import AST

# -- methods ---------------------------------------------------------------------------------------------------------
Method = Callable[[Evaluator, Reference, list[Value], dict[str, Value], AST, Frame], Value]
LIST: dict[str, Method] = {}
DICT: dict[str, Method] = {}
SET: dict[str, Method] = {}


def method(table: dict[str, Method], *names: str) -> Callable[[Method], Method]:
    def register(function: Method) -> Method:
        table.update(dict.fromkeys(names, function))
        return function
    return register


@operation
def container_method(ev: Evaluator, base: Value, name: str, args: list[Value], keywords: dict[str, Value], node: AST,
                     f: Frame) -> Value:
    """The call of a method of a list, a dict, a set, a tuple or a text."""
    if isinstance(base, Data):
        given = [TupleValue(tuple(ev.items_of(a, node, f))) if isinstance(a, (Iteration, Reference)) else a
                 for a in args]
        formats = name == "format" and not all(isinstance(a, Data) and a.is_known for a in (*given, *keywords.values()))
        if formats or any(isinstance(a, OpaqueValue) or isinstance(a, Data) and a.is_list for a in given):
            return OpaqueValue()
        found = getattr(base.known, name)(*(ev.known(a, node, "an argument of a method of a text") for a in given),
                                          **{k: ev.known(v, node, "an argument") for k, v in keywords.items()})
        return ev.list_of([constant(i) for i in found], node) if isinstance(found, list) else constant(found)
    if isinstance(base, TupleValue):
        return ev.tuple_method(base, name, args, keywords, node, f)
    if isinstance(base, ClassValue):        # _make
        return ev.constructed(base, ev.items_of(args[0], node, f), {}, node, f)
    if isinstance(base, MethodValue):
        return ev.dictionary_method(base, name, args, keywords, node, f)
    if isinstance(base, ResidualObject):
        return ev.residual_method(base, name, args, node, f)
    assert isinstance(base, Reference)
    if is_sparse(base, ev.heap):
        return ev.matrix_method(base, name, args, keywords, node, f)
    held = ev.heap[base]
    table = {"list": LIST, "dict": DICT, "set": SET}[held.kind]
    if name not in table:
        raise ev.refusal(node, f".{name} of a {held.kind} is not supported in a kernel")
    if name not in _READING:
        ev.change(base, node)
    ev.called = name
    return table[name](ev, base, args, keywords, node, f)


_READING = ("copy", "count", "index", "get", "items", "keys", "values", "union", "intersection", "difference")


@operation
def replace_items(ev: Evaluator, base: Reference, items: Sequence[Value], node: AST) -> None:
    """A list holds other items; a deque that holds fewer the last ones."""
    most = ev.heap[base].most
    items = items if most is None else items[max(len(items) - most, 0):]
    label = ev.heap[base].label or "item"
    ev.heap.set_items(base, {k: ev.atoms(v, f"{label}_{k}", node) for k, v in enumerate(items)})


@method(LIST, "append")
def _append(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    replace_items(ev, base, [*ev.sequence_items(base), args[0]], node)
    return NONE


@method(LIST, "appendleft", "popleft", "rotate")
def _at_the_left(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    items, most = collections.deque(ev.sequence_items(base)), ev.heap[base].most
    if ev.called == "popleft" and not items:
        raise ev.no_item("popleft from a deque that has no items", node)
    first = [ev.known(a, node, "how far a deque is turned") for a in args] if ev.called == "rotate" else args
    found = getattr(items, ev.called)(*first)
    replace_items(ev, base, list(items)[:most], node)
    return NONE if found is None else found


@method(LIST, "extend")
def _extend(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    try:
        more = ev.items_of(args[0], node, f)
    except Unevaluated as reason:
        reason.site = reason.site or ev.heap[base].site
        raise
    replace_items(ev, base, [*ev.sequence_items(base), *more], node)
    return NONE


@method(LIST, "insert", "pop", "reverse", "remove", "clear", "index", "count")
def _as_list(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    return list_method(ev, base, ev.called, args, node)


@operation
def list_method(ev: Evaluator, base: Reference, name: str, args: list[Value], node: AST) -> Value:
    items, site = ev.sequence_items(base), ev.heap[base].site
    if name in ("insert", "pop"):
        if args and isinstance(args[0], Data) and not args[0].is_known:
            raise ev.unknown(node, "a place in a list must be known before the run", args[0], site=site)
        first = [ev.known(args[0], node, "a place in a list")] if args else []
        if name == "pop" and not -len(items) <= (first[0] if first else -1) < len(items):
            raise ev.no_item("pop from a list that has no such item", node)
        found = getattr(items, name)(*first, *args[1:])
    elif name in ("remove", "index", "count"):
        keys: list[Any] = [i.known if isinstance(i, Data) and i.is_known else i for i in items]
        wanted = args[0].known if isinstance(args[0], Data) and args[0].is_known else args[0]
        if any(ev.compares_fields(v) or ev.special_method(v, "__eq__", node, ev.entry) for v in (args[0], *items)):
            raise ev.refusal(node, f".{name} compares objects, whose class says what equal is", help="write a loop")
        if isinstance(wanted, Data) or any(isinstance(k, Data) for k in keys):
            raise ev.unknown(node, f".{name} compares items that are not known", args[0],
                             site=site if name == "remove" else None)
        if name == "count":
            return constant(keys.count(wanted))
        if wanted not in keys:
            raise ev.refusal(node, f".{name}: the list has no such item")
        place = keys.index(wanted)
        if name == "index":
            return constant(place)
        found = items.pop(place) and None
    else:
        found = getattr(items, name)()
    replace_items(ev, base, items, node)
    return NONE if found is None else found


@method(LIST, "sort")
def _sort(ev: Evaluator, base: Reference, args: list[Value], keywords: dict[str, Value], node: AST, f: Frame) -> Value:
    replace_items(ev, base, ev.sorted_items(ev.sequence_items(base), keywords, node, f), node)
    return NONE


@method(LIST, "copy")
def _copied(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    return ev.list_of(ev.sequence_items(base), node)


def _plain(held: Object) -> dict[Hashable, Value]:
    return {k: v for k, v in held.items.items() if k is not FACTORY}


@method(DICT, "keys", "values", "items")
def _view(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: Any, f: Frame) -> Value:
    return Iteration(ev.called, (base,))


@method(DICT, "get")
def _get(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    return _plain(ev.heap[base]).get(ev.key_of(args[0], node), args[1] if args[1:] else NONE)


@method(DICT, "setdefault")
def _setdefault(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    key = ev.key_of(args[0], node)
    if key not in _plain(ev.heap[base]):
        ev.assign_slot(base, key, args[1] if args[1:] else NONE, str(key), node)
    return ev.heap[base].items[key]


@method(DICT, "pop")
def _pop(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    items, key = dict(ev.heap[base].items), ev.key_of(args[0], node)
    if key not in items and not args[1:]:
        ev.throws(KeyError, node)
        raise ev.refusal(node, f"the dict has no key {key!r}")
    found = items.pop(key, args[1] if args[1:] else NONE)
    ev.heap.set_items(base, items)
    return found


@method(DICT, "copy")
def _dict_copy(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    return ev.new_dict(ev.heap[base].items, node)


@method(DICT, "update")
def _update(ev: Evaluator, base: Reference, args: list[Value], keywords: dict[str, Value], node: AST, f: Frame
            ) -> Value:
    more: dict[Hashable, Value] = dict_items(ev, args[0], node, f) if args else {}
    for k, v in {**more, **keywords}.items():
        ev.assign_slot(base, k, v, str(k), node)
    return NONE


@method(DICT, "clear")
@method(SET, "clear")
def _clear(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: AST, f: Frame) -> Value:
    ev.heap.set_items(base, {})
    return NONE


@operation
def dict_items(ev: Evaluator, value: Value, node: AST, f: Frame) -> dict[Hashable, Value]:
    """What `dict(value)` holds."""
    if ev.is_attribute_dictionary(value):
        value = ev.attributes_now(value, node)
    if isinstance(value, Reference) and ev.heap[value].kind == "dict":
        return _plain(ev.heap[value])
    pairs = [ev.items_of(pair, node, f) for pair in ev.items_of(value, node, f)]
    return {ev.key_of(k, node): v for k, v in pairs}


@method(SET, "add", "discard", "remove")
def _set_change(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: Any, f: Frame) -> Value:
    items, key = dict(ev.heap[base].items), ev.key_of(args[0], node)
    if ev.called == "add":
        items.setdefault(key, args[0])
    else:
        items.pop(key, None)
    ev.heap.set_items(base, items)
    return NONE


@method(SET, "union", "intersection", "difference")
def _set_algebra(ev: Evaluator, base: Reference, args: list[Value], _: Any, node: Any, f: Frame) -> Value:
    items, name = dict(ev.heap[base].items), ev.called
    for other in args:
        more = {ev.key_of(v, node): v for v in ev.items_of(other, node, f)}
        items = {"union": {**items, **more}, "intersection": {k: v for k, v in items.items() if k in more},
                 "difference": {k: v for k, v in items.items() if k not in more}}[name]
    return ev.heap.new(Object("set", items, site=node))
