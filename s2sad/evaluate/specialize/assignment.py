"""Assignments: to names, to items of structures and arrays, to attributes.
"""
from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.numeric_operators import OPERATORS
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation, statement
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.subscripts import attribute_name, sequence_and_place
from s2sad.evaluate.unpacking import item_count
from s2sad.evaluate.specialize.values import (
    NONE, UNKNOWN, ClassValue, Data, LibraryValue, ObjectValue, Reference, ResidualObject, ScopeValue, SliceValue,
    TupleValue, Value, constant, parts,
)
from s2sad.tree import AST


def holder_of(ev: Evaluator, f: Frame, name: str) -> Reference:
    """The frame in which a name is bound."""
    if name in f.nonlocals:
        outer = f.outer
        while outer is not None:
            if name in outer.local:
                return outer.reference
            outer = outer.outer
    return f.reference


@operation
def bind(ev: Evaluator, f: Frame, name: str, value: Value, origin: AST) -> None:
    """A name of the user's gets a value."""
    if isinstance(value, Reference) and not ev.heap[value].label:
        ev.heap.objects[value.number] = replace(ev.heap[value], label=name)
    holder = holder_of(ev, f, name)
    if name in f.nonlocals:
        ev.change(holder, origin)
    ev.assign_slot(holder, name, value, name, origin)


@operation
def store(ev: Evaluator, target: AST, value: Value, f: Frame, statement: AST | None = None) -> None:
    """The value to a target of any form; `statement` is where it comes from."""
    if isinstance(target, tree.Name):
        bind(ev, f, target.id, value, statement or target)
    elif isinstance(target, (tree.Tuple, tree.List)):
        _unpack(ev, target, value, f, statement or target)
    elif isinstance(target, tree.Starred):
        raise ev.refusal(target, "a starred target outside of a tuple")
    else:
        at, effects, rebound = len(ev.block), ev.effects, len(ev.rebound)
        base, key = place_of(ev, target, f)
        if ev.effects > effects:        # the value is there before its place is found
            value = ev.held_at(value, at, {*ev.rebound[rebound:]}, target)
        assign_to(ev, base, key, value, target, f, statement)


def _unpack(ev: Evaluator, target: Any, value: Value, f: Frame, statement: AST) -> None:
    targets = target.elts
    star = next((k for k, t in enumerate(targets) if isinstance(t, tree.Starred)), None)
    if isinstance(value, Data) and not value.is_known and star is not None:
        items = _all_items(ev, target, value, targets[star], f)
    elif isinstance(value, Data) and not value.is_known:
        shape = isinstance(value.node, tree.Attribute) and value.node.attr == "shape"
        value = value if shape else ev.unpackable(value, "unpacked", target, statement)
        items = [ev.item_of(value, constant(k), target, f) for k in range(len(targets))]
        items = [ev.atoms(i, t.id if isinstance(t, tree.Name) else "item", statement) for i, t in zip(items, targets)]
    else:
        items = ev.items_of(value, target, f)
    if star is not None and len(items) >= len(targets) - 1:
        last = len(items) - (len(targets) - star - 1)
        items = [*items[:star], ev.list_of(items[star:last], target), *items[last:]]
        targets = [t.value if isinstance(t, tree.Starred) else t for t in targets]
    if len(items) != len(targets):
        raise ev.refusal(target, f"{len(targets)} targets for {len(items)} values", code="S203")
    for t, item in zip(targets, items):
        store(ev, t, item, f, statement)


@operation
def unpackable(ev: Evaluator, value: Data, wanted: str, target: Any, origin: AST, is_row: bool = False) -> Data:
    """A value under a name, of which each target takes an item; the run counts these where nothing else does, and it
    is a row of an array, or an array: what a function gives may be a tuple."""
    named = ev.named(value, wanted, origin)
    count, length = len(target.elts), named.shape[0] if named.shape else named.count
    if length is None and not (is_row or named.shape or named.name in named.origins or named.is_list):
        return named
    if length is None:
        ev.raised_in_runs("builtins.ValueError", target)
        ev.emit(item_count(ev.spelled(named, target), count), target, True)
    elif length != count:
        raise ev.refusal(target, f"{count} targets for {length} values", code="S203")
    return named


def _all_items(ev: Evaluator, target: AST, value: Data, rest: Any, f: Frame) -> list[Value]:
    """The items of an array or of a tuple of the residual program, of which a starred target takes some."""
    shape = ev.shape_of(value)
    if value.count is None and not (shape.is_known and shape.known):
        raise ev.unknown(target, "how many values a starred target takes is not known before the run", shape,
                         help="take the rest by a slice: rest = x[1:]")
    n = value.count if value.count is not None else shape.known[0]
    is_read = any(isinstance(m, tree.Name) and m.id == rest.value.id and isinstance(m.ctx, tree.Load)
                  for m in tree.walk(f.captured.tree)) if isinstance(rest.value, tree.Name) else True
    shape_itself = isinstance(value.node, tree.Attribute) and value.node.attr == "shape"
    value = value if shape_itself else ev.named(value, "unpacked", target)
    items: list[Value] = [ev.item_of(value, constant(k), target, f) for k in range(n)]
    first = target.elts.index(rest)  # pyright: ignore[reportAttributeAccessIssue]
    last = n - (len(target.elts) - first - 1)  # pyright: ignore[reportAttributeAccessIssue]
    return items if is_read else [NONE if first <= k < last else ev.atoms(i, "item", target)
                                  for k, i in enumerate(items)]


def place_of(ev: Evaluator, target: Any, f: Frame) -> tuple[Value, Any]:
    """What a target is in, and its key there: an attribute's name, or an index."""
    _ask_of_listed(ev, target, f)
    if isinstance(target, tree.Attribute):
        return ev.value(target.value, f), attribute_name(target.attr, f)
    return sequence_and_place(ev, target, f)


def _ask_of_listed(ev: Evaluator, target: Any, f: Frame) -> None:
    """Asks for what a list of the run holds, and of which an array is written, as a row of a table."""
    inner = target
    while isinstance(inner, tree.Subscript):
        inner = inner.value
    if isinstance(inner, tree.Attribute) and isinstance(inner.value, tree.Name):
        held = ev.heap[holder_of(ev, f, inner.value.id)].items.get(inner.value.id)
        if isinstance(held, Reference) and held.number in ev.in_lists:
            raise ev.changed_in_list(held.number, target)


@operation
def assign_to(ev: Evaluator, base: Value, key: Any, value: Value, origin: AST, f: Frame, statement: AST | None = None
              ) -> None:
    """The value becomes an item or an attribute; `origin` is the target, in `statement`."""
    if ev.is_attribute_dictionary(base):
        ev.assign_attributes(base, {ev.key_of(key, origin): value}, origin, f)
        return
    base = ev.indexed(base, origin)
    if _is_none(base):
        raise ev.none_here(base, origin)
    if isinstance(base, Data) and key == "shape" and ev.reshape_in_place(base, value, origin):
        return
    if isinstance(base, Data):
        place = tree.at(tree.attribute(base.node, key), origin) if isinstance(
            key, str) else ev.subscripted(base, key, origin)
        ev.refuse_no_number(value, origin)
        stored = ev.spelled_item(ev.as_row(base.rows, value, origin), origin) if base.is_list else ev.spelled(
            value, origin)
        ev.emit(tree.assign(place, stored), statement or origin, True)
    elif isinstance(base, (Reference, ResidualObject)) and isinstance(key, str):
        ev.assign_attribute(base, key, value, origin, f)
    elif isinstance(base, ResidualObject) and base.table.kind != "record":
        ev.store_residual(base, key, value, origin, f)
    elif isinstance(base, ResidualObject):
        ev.call(ev.attribute_of(base, "__setitem__", origin, f), [key, value], {}, origin, f)
    elif isinstance(base, Reference) and ev.heap[base].kind == "record" and ev.heap[base].made is None:
        ev.assign_attribute(base, ev.key_of(key, origin), value, origin, f)  # pyright: ignore
    elif isinstance(base, Reference) and ev.heap[base].kind == "record":
        ev.call(ev.attribute_of(base, "__setitem__", origin, f), [key, value], {}, origin, f)
    elif is_sparse(base, ev.heap):
        ev.refuse_element(base, origin)
    elif isinstance(base, Reference):
        held = ev.change(base, origin)
        if isinstance(key, SliceValue) and held.kind == "list":
            _assign_part(ev, base, key, value, origin, f)
            return
        place = ev.item_key(base, key, origin)
        if held.kind not in ("list", "dict"):
            raise ev.refusal(origin, f"an item of a {held.kind} is assigned")
        label = f"{held.label}_{place}" if held.label else str(place)
        ev.assign_slot(base, place, value, label, origin)
    elif isinstance(base, TupleValue):
        raise ev.refusal(origin, f"{ev.subject(base, origin)} is a tuple, to which nothing can be assigned",
                         help="return the new value, or make it a list")
    elif isinstance(base, ClassValue) and isinstance(key, str):
        ev.assign_class_attribute(base, key, value, origin)
    elif isinstance(base, (ClassValue, ScopeValue, ObjectValue)):
        raise ev.refusal(origin, "an attribute of a class or a module is assigned",
                         help="keep it in an object that the kernel is given")
    else:
        raise ev.refusal(origin, "an assignment to this is not supported in a kernel")


def _assign_part(ev: Evaluator, base: Reference, part: SliceValue, value: Value, origin: AST, f: Frame) -> None:
    """`base[a:b] = value` of a list."""
    items = ev.sequence_items(base)
    try:
        items[ev.known_place(part, origin)] = ev.items_of(value, origin, f)
    except ValueError as error:
        raise ev.refusal(origin, str(error)) from None
    ev.replace_items(base, items, origin)


@statement("Assign")
def assign(ev: Evaluator, s: Any, f: Frame) -> None:
    first = s.targets[0]
    ev.wanted = {value: (name, s) for name, value in _bound(first, s.value)}
    if isinstance(first, (tree.Tuple, tree.List)):
        ev.spread.add(s.value)
    if isinstance(s.value, tree.Call) and len(s.targets) == 1:
        ev.targets = _simple_names(first)
    value = ev.carried(s.value, f)
    if len(s.targets) > 1 or isinstance(first, (tree.Tuple, tree.List)):
        value = _held_items(ev, value, s, f)
    for target in s.targets:
        store(ev, target, value, f, s)


def _bound(target: AST, value: AST) -> list[tuple[str, AST]]:
    """The names that a target binds, with what stands beside each."""
    if isinstance(target, tree.Name):
        return [(target.id, value)]
    if isinstance(target, (tree.Tuple, tree.List)) and isinstance(value, (tree.Tuple, tree.List)):
        return [pair for t, v in zip(target.elts, value.elts) for pair in _bound(t, v)]
    return []


def _simple_names(target: AST) -> tuple[str, ...]:
    """The names that a target is made of, if it is no more than these."""
    parts = target.elts if isinstance(target, tree.Tuple) else [target]
    names = [t.id for t in parts if isinstance(t, tree.Name)]
    return tuple(names) if len(names) == len(parts) == len({*names}) else ()


def _held_items(ev: Evaluator, value: Value, s: Any, f: Frame) -> Value:
    """What several targets take: each item under a name before the first is bound."""
    if not isinstance(value, TupleValue) or len(s.targets) > 1 or not isinstance(s.targets[0], (tree.Tuple, tree.List)):
        return ev.atoms(value, s.targets[0].id if isinstance(s.targets[0], tree.Name) else "value", s)
    targets = s.targets[0].elts
    simple = all(isinstance(t, tree.Name) for t in targets) and len(value.items) == len(targets)
    bound = {n for t in targets for n in _residual_names(ev, t.id, f)} if simple else set()
    if simple and not any(_mentions(v, bound) for v in value.items):
        names = [t.id for t in targets]
        return replace(value, items=tuple(v if isinstance(v, Data) and not v.is_atom and k == 0 else ev.atoms(v, n, s)
                                          for k, (v, n) in enumerate(zip(value.items, names))))
    wanted = [t.id if isinstance(t, tree.Name) else "item" for t in s.targets[0].elts]
    wanted += ["item"] * (len(value.items) - len(wanted))
    return replace(value, items=tuple(ev.atoms(v, w, s) for v, w in zip(value.items, wanted)))


def _residual_names(ev: Evaluator, target: str, f: Frame) -> list[str]:
    """The residual name that a name of the user's has now, which its new value may get."""
    now = ev.heap[holder_of(ev, f, target)].items.get(target)
    return [n.id for n in tree.walk(now.node) if isinstance(n, tree.Name)] if isinstance(now, Data) else []


def _mentions(value: Value, names: set[str]) -> bool:
    return any(isinstance(n, tree.Name) and n.id in names for n in tree.walk(value.node)) if isinstance(
        value, Data) else any(_mentions(part, names) for part in parts(value))


@statement("AnnAssign")
def annotated_assign(ev: Evaluator, s: Any, f: Frame) -> None:
    if s.value is not None:
        store(ev, s.target, ev.carried(s.value, f), f, s)


@statement("AugAssign")
def augmented_assign(ev: Evaluator, s: Any, f: Frame) -> None:
    if isinstance(s.target, tree.Name):
        read = tree.at(tree.name(s.target.id), s.target)
        old, value = ev.values([read, s.value], f)
        still = _holds(ev, (holder_of(ev, f, s.target.id), s.target.id), old)
        new = in_place(ev, old, value, s, f, s.target.id, still)
        if new is not None or not still:
            bind(ev, f, s.target.id, old if new is None else new, s)
        return
    base, key = place_of(ev, s.target, f)
    base = ev.indexed(base, s)
    if isinstance(base, ResidualObject) and ev.is_held_plainly(base, key, s.target, f):
        base, key = ev.residual_place(base, key, s.target) or (base, key)
    if isinstance(base, Data) and not ev.holds_objects(base):
        _augmented_part(ev, s, base, key, f)
        return
    old = ev.attribute_of(base, key, s.target, f) if isinstance(key, str) else ev.item_of(base, key, s.target, f)
    at, rebound, effects = len(ev.block), len(ev.rebound), ev.effects
    slot = _slot(ev, base, key, old)
    value = ev.value(s.value, f)
    if ev.effects > effects:
        old = ev.held_at(old, at, {*ev.rebound[rebound:]}, s)
    still = slot is not None and _holds(ev, slot, old)
    label = ev.heap[base].label if isinstance(base, Reference) else ""
    wanted = str(key) if isinstance(key, str) else "item"
    new = in_place(ev, old, value, s, f, f"{label}_{wanted}" if label else wanted, still)
    if new is not None or slot is not None and not still or _stores_otherwise(ev, base, key, s, f):
        assign_to(ev, base, key, old if new is None else new, s, f)


Slot = tuple[Reference, Hashable]


def _slot(ev: Evaluator, base: Value, key: Any, old: Value) -> Slot | None:
    """The slot that a target is, which holds this; None where what it gives comes from elsewhere, as by a property."""
    if not isinstance(base, Reference):
        return None
    items, place = ev.heap[base].items, key.known if isinstance(key, Data) and key.is_known else key
    if ev.heap[base].kind == "list" and type(place) is int and place < 0:
        place += len(items)
    found: Slot = base, place
    return found if isinstance(place, Hashable) and _holds(ev, found, old) else None


def _holds(ev: Evaluator, slot: Slot, value: Value) -> bool:
    """Whether a slot holds a value, no other that is computed alike."""
    held = ev.heap[slot[0]].items.get(slot[1])
    return held is value or isinstance(held, Reference) and held == value or isinstance(held, Data) and isinstance(
        value, Data) and bool(held.name) and held.name == value.name


def _augmented_part(ev: Evaluator, s: Any, base: Any, key: Any, f: Frame) -> None:
    """`base[key] op= value` of an array: an element is read before the value is computed, a part behind that."""
    if _is_none(base):
        raise ev.none_here(base, s.target)
    at, effects, rebound, gathers = len(ev.block), ev.effects, len(ev.rebound), _gathers(key)
    value = ev.value(s.value, f)
    changes, is_part = ev.effects > effects, isinstance(key, (str, SliceValue))
    is_part |= base.is_list and not any(_may_fill(n, base.name) for s in ev.block[at:] for n in tree.walk(s))
    if changes:
        before = len(ev.block)
        gone = {*ev.rebound[rebound:]}
        base = ev.held_at(base, at, gone, s)
        key = key if isinstance(key, str) else ev.held_at(key, at, gone, s)
        at += len(ev.block) - before
    place = tree.attribute(base.node, key) if isinstance(key, str) else ev.subscripted(base, key, s)
    ev.refuse_no_number(value, s)
    picks = isinstance(key, Data) and base.shape is not None and len(base.shape) == 1     # numbers, which are copied
    if changes and not is_part and not picks:
        if not gathers and (not base.shape or _rank(key) > len(base.shape)):
            raise ev.refusal(s, "what is added to an element changes something first",
                             help="give it a name in a statement of its own before")
        is_part = not gathers and _rank(key) < len(base.shape or ())
    if changes and not is_part:
        old = ev.held_at(ev.item_of(base, key, s.target, f), at, set(), s)
        ev.emit(tree.assign(place, ev.spelled(ev.binary(s.op, old, value, s, f), s)), s, True)
    elif isinstance(s.op, tree.MatMult) and not base.is_list and not isinstance(key, str):
        whole = Data(ev.subscripted(base, key, s))
        ev.emit(tree.assign(place, ev.spelled(ev.binary(s.op, whole, value, s, f), s)), s, True)
    else:
        ev.emit(tree.augment(place, s.op, ev.spelled(value, s)), s, True)


def _is_none(base: Value) -> bool:
    return isinstance(base, Data) and base.is_known and base.known is None


def _may_fill(node: AST, listed: str) -> bool:
    """Whether a part of a statement may put something else into a list of the residual program."""
    stores = isinstance(node, tree.Subscript) and not isinstance(node.ctx, tree.Load)
    return (stores or isinstance(node, tree.Call)) and any(
        isinstance(n, tree.Name) and n.id == listed for n in tree.walk(node))


def _rank(key: Any) -> int:
    """How many axes an index of numbers takes away; more than there are where it may have others."""
    items = key.items if isinstance(key, TupleValue) else (key,)
    if all(isinstance(i, Data) and (type(i.known) is int or i.shape == ()) for i in items):
        return len(items)
    return 99


def _gathers(key: Any) -> bool:
    """Whether an index picks elements by arrays or lists, which are a copy."""
    items = key.items if isinstance(key, TupleValue) else (key,)
    return any(isinstance(i, (TupleValue, Reference)) or isinstance(i, Data) and (
        bool(i.shape) or isinstance(i.node, tree.Subscript) and any(isinstance(p, tree.Slice) for p in tree.indices(
            i.node))) for i in items)


def _stores_otherwise(ev: Evaluator, base: Value, key: Any, s: AST, f: Frame) -> bool:
    """Whether more is done than to hold what is assigned: by a property, or a class of the user's."""
    if not isinstance(base, ResidualObject) and (not isinstance(base, Reference) or ev.heap[base].kind != "record"):
        return False
    found = ev.class_item(ev.class_of(base), key, s, f) if isinstance(key, str) else None
    return not isinstance(key, str) or found is not None and isinstance(found[1], LibraryValue)


def _is_list(ev: Evaluator, value: Value) -> bool:
    return isinstance(value, Reference) and ev.heap[value].kind == "list"


def _object_in_place(ev: Evaluator, old: Value, value: Value, s: Any, f: Frame) -> Value:
    """What `old op= value` gives, as the class of an object says."""
    method = ev.method_named(ev.class_of(old), f"__i{OPERATORS[type(s.op)][1]}__", old, s, f)
    return ev.binary(s.op, old, value, s, f) if method is None else ev.call(method, [value], {}, s, f)


def in_place(ev: Evaluator, old: Value, value: Value, s: Any, f: Frame, wanted: str, still: bool) -> Value | None:
    """What `old op= value` leaves: an array keeps being the one that it is. None where that is what was there before;
    a number's name is bound anew where the target holds it `still`, and nothing else does."""
    if is_sparse(old, ev.heap):
        return ev.matrix_in_place(s.op, old, value, s)
    if isinstance(old, Reference):
        held = ev.heap[old]
        if held.kind == "list" and isinstance(s.op, tree.Add):
            ev.container_method(old, "extend", [value], {}, s, f)
            return None
        if held.kind == "record":
            return _object_in_place(ev, old, value, s, f)
    if isinstance(old, ResidualObject):
        if old.table.kind != "record":
            raise ev.refusal(s, f"{ev.kind_of(old)} of which only the run knows which it is is added to",
                             help="assign its items")
        return _object_in_place(ev, old, value, s, f)
    if isinstance(old, Data) and old.is_list and isinstance(s.op, tree.Add):
        return ev.extend_residual(old, value, s, f)
    if not isinstance(old, Data) or old.is_known and old.is_literal or not isinstance(
            value, (Data, TupleValue)) and not _is_list(ev, value):
        return ev.binary(s.op, old, value, s, f)
    ev.refuse_no_number(value, s)
    if old.name and old.shape:      # an array under a name of its own
        ev.emit(tree.augment(tree.copy(old.node), s.op, ev.spelled(value, s)), s, True)
        return None
    if not still or not ev.owns(old.name):
        new = ev.fresh(wanted)
        ev.emit(tree.assign(new, old.node), s)
        old = replace(old, node=tree.at(tree.name(new), s), known=UNKNOWN)
    ev.rebound.append(old.name)
    ev.emit(tree.augment(old.name, s.op, ev.spelled(value, s)), s, True)
    more = value.demands if isinstance(value, Data) else frozenset()
    return replace(old, known=UNKNOWN, demands=old.demands | more, shape=old.shape or None)
