"""Conditional expressions, and, or.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator, Frame, expression
from s2sad.evaluate.specialize.values import Data, Value, constant, demands_of
from s2sad.tree import AST


# -- choices ---------------------------------------------------------------------------------------------------------
@expression("IfExp")
def conditional(ev: Evaluator, node: Any, f: Frame) -> Value:
    test = ev.test_of(node.test, f)
    if not isinstance(test, Data):
        return ev.value(node.body if test else node.orelse, f)
    before = ev.snapshot()
    plain = [ev.value(part, f) for part in (node.body, node.orelse)]
    if len(ev.block) == len(before.block) and all(isinstance(v, Data) and not is_structural(v) for v in plain):
        body, orelse = (ev.spelled(v, node) for v in plain)
        return Data(tree.at(tree.IfExp(test.node, body, orelse), node), demands=demands_of(*plain))
    ev.restore(before)
    return chosen(ev, test, (lambda: ev.value(node.body, f), lambda: ev.value(node.orelse, f)), node, f)


def is_structural(value: Value) -> bool:
    return isinstance(value, Data) and value.is_known and (value.known is None or isinstance(value.known, str))


def chosen(ev: Evaluator, test: Data, arms: Sequence[Callable[[], Value]], node: AST, f: Frame) -> Value:
    """What one of two ways gives, which have statements of their own."""
    slot = f".choice{id(node)}"

    def arm(way: Callable[[], Value]) -> Callable[[], None]:
        return lambda: ev.heap.put(f.reference, slot, ev.atoms(way(), "choice", node))
    ev.branch(test, [arm(a) for a in arms], node)
    items = dict(ev.heap[f.reference].items)
    found = items.pop(slot)
    ev.heap.set_items(f.reference, items)
    return found


@expression("BoolOp")
def boolean(ev: Evaluator, node: Any, f: Frame) -> Value:
    return _boolean(ev, node, list(node.values), f)


def _boolean(ev: Evaluator, node: Any, left: list[Any], f: Frame) -> Value:
    stops = isinstance(node.op, tree.Or)
    value = ev.value(left[0], f)
    if len(left) == 1:
        return value
    test = ev.truth(value, left[0], f)
    if not isinstance(test, Data):
        return value if test is stops else _boolean(ev, node, left[1:], f)
    before = ev.snapshot()
    rest = _boolean(ev, node, left[1:], f)
    if len(ev.block) > len(before.block):      # evaluated only where the first does not decide
        ev.restore(before)
        kept = ev.named(test, "test", node)
        arms = (lambda: kept, lambda: _boolean(ev, node, left[1:], f))
        return chosen(ev, kept, arms if stops else arms[::-1], node, f)
    known = ev.truth(rest, node, f)
    if not isinstance(known, Data):
        if known is stops:
            return constant(stops) if isinstance(value, Data) else value
        return test
    first = ev.spelled(test, node)
    more = rest.node.values if isinstance(rest, Data) and isinstance(rest.node, tree.BoolOp) and type(
        rest.node.op) is type(node.op) else [ev.spelled(rest, node)]
    return Data(tree.at(tree.BoolOp(node.op, [first, *more]), node), demands=demands_of(test, rest))
