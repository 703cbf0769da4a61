"""Constants, names, displays, texts.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression
from s2sad.evaluate.specialize.signals import Unbound, Unevaluated
from s2sad.evaluate.specialize.values import (
    Data, OpaqueValue, Reference, ResidualObject, TupleValue, Value, constant, demands_of, parts, with_parts,
)
from s2sad.tree import AST


# -- plain ones ------------------------------------------------------------------------------------------------------
@expression("Constant")
def constant_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    return Data(tree.at(tree.const(node.value), node), node.value)


@expression("Name")
def name_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    frame: Frame | None = f
    while frame is not None:
        items = ev.heap[frame.reference].items
        if node.id in items:
            return _read(ev, items[node.id])
        if node.id in frame.local and frame is f:
            error = ev.refusal(node, f"'{node.id}' is read before it is bound", help="bind it on every way")
            inside = any(not isinstance(loop, tuple) for loop in ev.loops[f.loops:])
            raise Unbound(f.reference.number, node.id, error) if inside else error
        frame = frame.outer
    return ev.outside_name(node.id, node, f)


def _read(ev: Evaluator, value: Value) -> Value:
    """What is read of a name: it is bound from here on, or the program has ended."""
    if isinstance(value, (TupleValue, ResidualObject)):
        return with_parts(value, [_read(ev, v) for v in parts(value)])
    if isinstance(value, Data) and value.may_be_unbound:
        ev.unsure.add(value.name)
        return replace(value, may_be_unbound=False)
    return value


@expression("Tuple")
def tuple_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    items = starred(ev, node.elts, f)
    ev.counted(items, node)
    return TupleValue(tuple(items))


@expression("List")
def list_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    return ev.as_residual(ev.list_of(starred(ev, node.elts, f), node), node)


@expression("Set")
def set_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    return ev.new_set(starred(ev, node.elts, f), node)


def starred(ev: Evaluator, nodes: Sequence[Any], f: Frame) -> list[Value]:
    """The values of a display, starred ones as their items."""
    return flat(nodes, ev.values(nodes, f, carries=True))


def flat(nodes: Sequence[AST], values: Sequence[Value]) -> list[Value]:
    """Values with the items of starred ones in their place."""
    return [i for n, v in zip(nodes, values) for i in (
        v.items if isinstance(n, tree.Starred) and isinstance(v, TupleValue) else [v])]


@expression("Dict")
def dict_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    nodes = [n for pair in zip(node.keys, node.values) for n in pair if n is not None]
    values, found = iter(ev.values(nodes, f, carries=True)), {}
    for key in node.keys:
        if key is None:
            merged = next(values)
            if ev.is_attribute_dictionary(merged):
                merged = ev.attributes_now(merged, node)
            if not isinstance(merged, Reference) or ev.heap[merged].kind != "dict":
                raise ev.unknown(node, "what ** unpacks must be a dict that is known", merged)
            found |= ev.heap[merged].items
        else:
            k = ev.key_of(next(values), key)
            found[k] = next(values)
    return ev.as_residual(ev.new_dict(found, node), node)


@expression("JoinedStr")
def f_string(ev: Evaluator, node: Any, f: Frame) -> Value:
    found = ""
    unknown: list[Value] = []
    for part in node.values:
        if isinstance(part, tree.Constant):
            found += str(part.value)
            continue
        value = ev.value(part.value, f)
        try:
            known = ev.known(value, part.value, "what a text is made of")
        except Unevaluated:
            unknown.append(value)
            continue
        shown = {114: repr, 115: str, 97: ascii}.get(part.conversion, lambda v: v)(known)
        spec = ev.known(ev.value(part.format_spec, f), part, "a format") if part.format_spec is not None else ""
        found += format(shown, spec)
    return OpaqueValue(demands=demands_of(*unknown)) if unknown else constant(found)


@expression("NamedExpr")
def walrus(ev: Evaluator, node: Any, f: Frame) -> Value:
    name, holder = node.target.id, f
    while holder.outer is not None and name not in holder.local | holder.nonlocals:     # a comprehension has none
        holder = holder.outer
    ev.bind(holder, name, ev.value(node.value, f), node)
    return ev.value(tree.at(tree.name(node.target.id), node), f)


@expression("Lambda")
def lambda_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    return ev.defined(node, f)
