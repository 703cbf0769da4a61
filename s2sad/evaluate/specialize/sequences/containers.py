"""Lists, dicts, sets, tuples and texts: their items, operators and methods, as Python has them.
"""
from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from enum import Enum
from typing import Any

from s2sad import tree
from s2sad.diagnostics import S2sadError
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.residual_lists import COUNTED
from s2sad.evaluate.specialize.values import (
    FACTORY, ClassValue, Data, FunctionValue, Iteration, ObjectValue, Reference, SliceValue, TupleValue, Value,
    constant,
)
from s2sad.tree import AST


@operation
def key_of(ev: Evaluator, value: Value, node: AST) -> Hashable:
    """A key of a dict, or an item of a set: what is known, or an object that is compared by identity."""
    if isinstance(value, Reference) and (ev.compares_fields(value) or ev.class_item(
            ev.class_of(value), "__eq__", node, ev.entry) is not None):
        raise ev.refusal(node, "a key of a class that says what equal is", help="use a text or a number")
    if isinstance(value, Reference) and ev.heap[value].kind == "set":
        return frozenset(ev.heap[value].items)
    if isinstance(value, (Reference, FunctionValue, ObjectValue, ClassValue)):
        return value
    if isinstance(value, TupleValue):
        return tuple(key_of(ev, v, node) for v in value.items)
    return ev.known(value, node, "a key")


@operation
def new_dict(ev: Evaluator, items: Mapping[Hashable, Value], origin: AST) -> Reference:
    held = {k: ev.atoms(v, k if isinstance(k, str) else "item", origin) for k, v in items.items()}
    return ev.heap.new(Object("dict", held, site=origin))


@operation
def new_set(ev: Evaluator, items: Sequence[Value], origin: AST) -> Reference:
    return ev.heap.new(Object("set", {key_of(ev, v, origin): v for v in items}, site=origin))


@operation
def picked(ev: Evaluator, base: Value, place: Value, node: AST, f: Frame) -> Value:
    """An item, or a part, of a sequence or a dict."""
    if isinstance(base, Iteration) and base.kind in ("range", "keys", "values", "items"):
        base = TupleValue(tuple(ev.items_of(base, node, f)))
    if not isinstance(base, (Reference, TupleValue)):
        if isinstance(base, ClassValue):
            return _of_class(ev, base, place, node, f)
        raise ev.refusal(node, f"an item of {ev.kind_of(base)}")
    held = ev.heap[base] if isinstance(base, Reference) else None
    if held is not None and held.kind == "dict":
        return _value(ev, base, held, place, node, f)
    items = list(held.items.values()) if held is not None else list(base.items)  # pyright: ignore
    if isinstance(place, SliceValue):
        part = items[slice(*(ev.known(p, node, "an end of a slice of a list") for p in place.parts))]
        return ev.list_of(part, node) if held is not None else TupleValue(tuple(part))
    if not isinstance(place, Data) or not place.is_known:
        return _by_variable(ev, base, place, node, held)
    if not -len(items) <= place.known < len(items):
        raise no_item(ev, f"{ev.subject(base, node)} has {len(items)} items, and no item {place.known}", node)
    return items[place.known]


@operation
def no_item(ev: Evaluator, message: str, node: AST) -> S2sadError:
    """What is said of an item that a sequence does not have; where only some runs come here, or a loop fills it later,
    these raise what Python raises."""
    ev.throws(IndexError, node)
    if not ev.is_sure():
        ev.raises("builtins.IndexError", [tree.const(message)], node)
    return ev.refusal(node, message, code="S203")


def _value(ev: Evaluator, base: Value, held: Object, place: Value, node: AST, f: Frame) -> Value:
    key = key_of(ev, place, node)
    if key in held.items:
        return held.items[key]
    factory = held.items.get(FACTORY)
    if factory is not None and isinstance(base, Reference):
        made = ev.call(factory, [], {}, node, f)
        ev.assign_slot(base, key, made, str(key), node)
        return ev.heap[base].items[key]
    ev.throws(KeyError, node)
    if not ev.is_sure() and isinstance(key, (str, int)):
        ev.raises("builtins.KeyError", [tree.const(key)], node)
    if held.live is not None:
        missing = ev.missing(node, held.label, f"[{key!r}]", [f"[{k!r}]" for k in held.items])
        raise S2sadError(*missing.diagnostics)      # reading knows no keys
    raise ev.refusal(node, f"{ev.subject(base, node)} has no key {key!r}",
                     f"its keys are {', '.join(map(str, held.items))}", "S202")


def _of_class(ev: Evaluator, base: ClassValue, place: Value, node: AST, f: Frame) -> Value:
    """`Edge["PERIODIC"]` of an enumeration; `list[int]` is the class."""
    if isinstance(base.live, type) and issubclass(base.live, Enum):
        return ev.attribute_of(base, ev.known(place, node, "a member's name"), node, f)
    return base


def _by_variable(ev: Evaluator, base: Value, place: Value, node: AST, held: Object | None) -> Value:
    """An item that a variable picks: of a table of numbers, an array's; else it must be known."""
    if (item := ev.table_item(base, place, node)) is not None:
        return item
    label = f" of '{held.label}'" if held is not None and held.label else ""
    apart = held is not None and _grow_apart(ev, held)
    raise ev.unknown(node, f"which item{label} is meant must be known before the run", place, help=(
        f"loop over a range that is known, or {COUNTED if apart else 'keep the items in one array'}"),
        site=held.site if held is not None and held.kind == "list" and not apart else None)


def _grow_apart(ev: Evaluator, held: Object) -> bool:
    """Whether a list holds lists that are filled each apart, and have lengths of their own: no table has such rows."""
    return held.kind == "list" and any(
        i.is_list if isinstance(i, Data) else isinstance(i, Reference) and ev.heap[i].kind == "list"
        and not ev.heap[i].items for i in held.items.values())


def _repeated(ev: Evaluator, sequence: Reference, times: Data, node: AST) -> Value | None:
    """A constant as often as only the run knows, in a list of the residual program; None for anything else."""
    items = list(ev.heap[sequence].items.values())
    if len(items) != 1 or not isinstance(items[0], Data) or not items[0].is_literal:
        return None
    item, count, wanted = items[0], ev.spelled(times, node), ev.wanted.get(node, ("items", node))[0]
    unfilled = tree.BinOp(ev.spelled(sequence, node), tree.Mult(), count)
    empty = unfilled if item.known is None else tree.List([], tree.Load())
    made = ev.named(Data(tree.at(empty, node), is_list=True, demands=times.demands,
                         rows=None if item.known is None else ev.listed_records(node)), wanted, node)
    if item.known is not None:
        ev.as_row(made.rows, item, node)
        append = tree.Call(tree.attribute(made.node, "append"), [ev.spelled(item, node)], [])
        ev.emit(tree.counted_for(ev.fresh("each"), [tree.copy(count)], [tree.Expr(append)]), node)
    return made


# -- operators -------------------------------------------------------------------------------------------------------
@operation
def container_operator(ev: Evaluator, op: AST, left: Value, right: Value, node: AST, f: Frame) -> Value | None:
    """`+`, `*`, `|`, `%` of sequences, dicts, sets and texts; None where neither operand is one."""
    kinds = [_kind(ev, v) for v in (left, right)]
    if isinstance(op, tree.Add) and kinds == ["tuple", "tuple"]:
        ev.counted((*left.items, *right.items), node)  # pyright: ignore
        return TupleValue((*left.items, *right.items))  # pyright: ignore
    if isinstance(op, tree.Add) and kinds == ["list", "list"]:
        return ev.list_of([*sequence_items(ev, left), *sequence_items(ev, right)], node)
    if isinstance(op, tree.Add) and all(isinstance(v, Data) and v.is_list for v in (left, right)) and any(
            v.rows is not None and v.rows.known.form for v in (left, right)):  # pyright: ignore
        return ev.joined_lists((left, right), node, f)
    if isinstance(op, tree.Add) and "list" in kinds and any(isinstance(v, Data) and v.is_list for v in (left, right)):
        residual = [v for v in (left, right) if isinstance(v, Data)]
        if not any(v.demands for v in residual):        # no facts would tell
            return ev.joined_lists((left, right), node, f)
        raise ev.unknown(node, "how long a list is must be known where another one is added", residual[0])
    if isinstance(op, tree.Mult) and any(k in ("list", "tuple") for k in kinds):
        sequence, times = (left, right) if kinds[0] in ("list", "tuple") else (right, left)
        if isinstance(times, Data) and (not times.is_known and not times.shape or type(times.known) is int):
            if isinstance(sequence, Reference) and not times.is_known and (
                    made := _repeated(ev, sequence, times, node)) is not None:
                return made
            n = ev.known(times, node, "how often a list is repeated")
            items = [ev.atoms(i, "item", node) for i in sequence_items(ev, sequence)]
            ev.counted(items, node, max(n, 0))
            return ev.list_of(items * n, node) if isinstance(sequence, Reference) else TupleValue(tuple(items * n))
    if isinstance(op, tree.BitOr) and kinds == ["dict", "dict"]:
        return new_dict(ev, {**ev.heap[left].items, **ev.heap[right].items}, node)  # pyright: ignore
    if "set" in kinds and kinds[0] == kinds[1]:
        a, b = (ev.heap[v].items for v in (left, right))  # pyright: ignore
        made = {tree.BitOr: {**a, **b}, tree.BitAnd: {k: v for k, v in a.items() if k in b},
                tree.Sub: {k: v for k, v in a.items() if k not in b},
                tree.BitXor: {k: v for k, v in {**a, **b}.items() if (k in a) is not (k in b)}}.get(type(op))
        return None if made is None else ev.heap.new(Object("set", made, site=node))
    if isinstance(op, tree.Mod) and isinstance(left, Data) and isinstance(left.known, str):
        return constant(left.known % ev.known(right, node, "what a text is made of"))
    _refuse_missing(ev, op, left, right, kinds, node)
    return None


def _refuse_missing(ev: Evaluator, op: AST, left: Value, right: Value, kinds: list[str], node: AST) -> None:
    """Refuses an operator that Python does not have for a list or a tuple: beside an array it is NumPy's, and so is any
    but the product beside a number of NumPy's, which one that is not written may be."""
    found = [k for k in kinds if k in ("list", "tuple")]
    if len(found) == 1:
        other, word = (right, "right") if kinds[0] else (left, "left")
        is_number = isinstance(other, Data) and other.is_known and isinstance(other.known, (int, float))
        if not is_number or not isinstance(op, tree.Mult) and not isinstance(getattr(node, word, None), tree.Constant):
            return
    if found:
        raise ev.refusal(node, f"Python has no such operator for a {found[0]}", help="make it an array with np.array")


def _kind(ev: Evaluator, value: Value) -> str:
    if isinstance(value, Reference):
        return ev.heap[value].kind
    return "tuple" if isinstance(value, TupleValue) else ""


@operation
def sequence_items(ev: Evaluator, value: Any) -> list[Value]:
    return list(ev.heap[value].items.values()) if isinstance(value, Reference) else list(value.items)
