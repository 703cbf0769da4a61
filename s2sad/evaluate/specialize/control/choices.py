"""Conditional expressions, and, or.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression
from s2sad.evaluate.specialize.signals import Leave
from s2sad.evaluate.specialize.heap import Temporary
from s2sad.evaluate.specialize.values import Data, Value, constant, demands_of
from s2sad.tree import AST


# -- choices ---------------------------------------------------------------------------------------------------------
@expression("IfExp")
def conditional(ev: Evaluator, node: Any, f: Frame) -> Value:
    test = ev.test_of(node.test, f)
    if not isinstance(test, Data):
        return ev.value(node.body if test else node.orelse, f)
    before = ev.snapshot()
    both = [_unless_left(ev, part, f, test.demands) for part in (node.body, node.orelse)]
    plain = [v for v in both if isinstance(v, Data) and not is_structural(v)]
    if not ev.has_acted(before) and len(plain) == len(both):
        body, orelse = (ev.spelled(v, node) for v in plain)
        return Data(tree.at(tree.IfExp(test.node, body, orelse), node), demands=demands_of(*plain))
    ev.restore(before)
    return chosen(ev, test, (lambda: ev.carried(node.body, f), lambda: ev.carried(node.orelse, f)), node, f)


def _unless_left(ev: Evaluator, node: AST, f: Frame, demands: frozenset[Any], is_test: bool = False) -> Value | None:
    """What an expression gives that may not be evaluated, as facts may tell; None where it raises."""
    around, ev.guarded = ev.guarded, (*ev.guarded, demands)
    try:
        return _test(ev, node, f) if is_test else ev.carried(node, f)
    except Leave:
        return None
    finally:
        ev.guarded = around


def is_structural(value: Value) -> bool:
    return isinstance(value, Data) and value.is_known and (value.known is None or isinstance(value.known, str))


def chosen(ev: Evaluator, test: Data, arms: Sequence[Callable[[], Value]], node: AST, f: Frame) -> Value:
    """What one of two ways gives, which have statements of their own."""
    slot = Temporary("choice", id(node))

    def arm(way: Callable[[], Value]) -> Callable[[], None]:
        return lambda: ev.heap.put(f.reference, slot, ev.atoms(way(), "choice", node))
    ev.branch(test, [arm(a) for a in arms], node)
    items = dict(ev.heap[f.reference].items)
    found = items.pop(slot)
    ev.heap.set_items(f.reference, items)
    return found


@expression("BoolOp")
def boolean(ev: Evaluator, node: Any, f: Frame) -> Value:
    return boolean_of(ev, node, list(node.values), f)


def boolean_of(ev: Evaluator, node: Any, operands: Sequence[Any], f: Frame, is_test: bool = False) -> Value:
    """The operand that decides; where it `is_test`, what is as true as that. Operands with statements of their own are
    evaluated where none before them decides."""
    stops = isinstance(node.op, tree.Or)
    found: list[Data] = []      # operands of which only the run knows whether they decide
    for k, operand in enumerate(operands):
        before, is_last = ev.snapshot(), k == len(operands) - 1
        value, test = _operand(ev, operand, found, is_test, is_last, f)
        if isinstance(test, bool) and test is not stops and not (is_last and not is_test) and not (
                found and ev.has_acted(before)):
            continue
        if found and (ev.has_acted(before) or not isinstance(value, Data) or is_structural(value)):
            ev.restore(before)
            kept = ev.named(_joined(ev, node, found), "test", node)
            decided = constant(stops) if is_test else kept
            return _either(ev, node, kept, decided, lambda k=k: boolean_of(ev, node, operands[k:], f, is_test), f)
        if test is stops and (is_test or all(is_bool(v) for v in found) and is_bool(value)):
            return constant(stops) if found else value
        if isinstance(test, Data) and not isinstance(value, Data):      # an object, which says whether it is true
            kept = ev.named(test, "test", node)
            return _either(ev, node, kept, value, lambda k=k: boolean_of(ev, node, operands[k + 1:], f, is_test), f)
        if not isinstance(value, Data):
            return value
        found.append(value)
        if test is stops:
            break
    return _joined(ev, node, found) if found else constant(not stops)


def _operand(ev: Evaluator, node: AST, before: Sequence[Data], is_test: bool, is_last: bool, f: Frame
             ) -> tuple[Any, bool | Data | None]:
    """The value of an operand, None where it raises and those before it may decide, and whether it is true."""
    if before:
        value = _unless_left(ev, node, f, demands_of(*before), is_test)
        if value is None:
            return None, None
    else:
        value = _test(ev, node, f) if is_test else ev.value(node, f)
    return value, ev.truth(value, node, f) if is_test or not is_last else None


def _either(ev: Evaluator, node: Any, test: Data, decided: Value, rest: Callable[[], Value], f: Frame) -> Value:
    """What has decided where the test says so, else the rest."""
    arms = (lambda: decided, rest)
    return chosen(ev, test, arms if isinstance(node.op, tree.Or) else arms[::-1], node, f)


def _joined(ev: Evaluator, node: Any, values: Sequence[Data]) -> Data:
    """Several operands of one operator."""
    if len(values) == 1:
        return values[0]
    nodes = [n for v in values for n in (v.node.values if isinstance(v.node, tree.BoolOp) and type(
        v.node.op) is type(node.op) else [ev.spelled(v, node)])]
    return Data(tree.at(tree.BoolOp(node.op, nodes), node), demands=demands_of(*values))


def _test(ev: Evaluator, node: AST, f: Frame) -> Value:
    found = ev.test_of(node, f)
    return found if isinstance(found, Data) else constant(found)


def is_bool(value: Value) -> bool:
    """Whether a value is True or False, and not only as true or false as something."""
    return isinstance(value, Data) and (isinstance(value.known, bool) or _gives_bool(value.node))


def _gives_bool(node: Any) -> bool:
    if isinstance(node, tree.BoolOp):
        return all(map(_gives_bool, node.values))
    return isinstance(node, tree.Compare) or isinstance(node, tree.UnaryOp) and isinstance(node.op, tree.Not)
