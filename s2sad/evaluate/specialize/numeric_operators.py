"""Operators of one and two operands, those of classes among them.
"""
from __future__ import annotations

import operator
from collections.abc import Callable
from enum import Flag
from typing import Any

from s2sad import tree
from s2sad.diagnostics import S2sadError
from s2sad.evaluate.specialize.classes.enumerations import combined
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression, operation
from s2sad.evaluate.specialize.sequences.known_shapes import broadcast, of_call, origins, shape
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    UNKNOWN, Data, LibraryValue, ObjectValue, OpaqueValue, Reference, ResidualObject, TupleValue, Value, constant,
    demands_of,
)
from s2sad.tree import AST

OPERATORS: dict[type, tuple[Callable[[Any, Any], Any], str]] = {
    tree.Add: (operator.add, "add"), tree.Sub: (operator.sub, "sub"), tree.Mult: (operator.mul, "mul"),
    tree.Div: (operator.truediv, "truediv"), tree.FloorDiv: (operator.floordiv, "floordiv"),
    tree.Mod: (operator.mod, "mod"), tree.Pow: (operator.pow, "pow"), tree.MatMult: (operator.matmul, "matmul"),
    tree.BitAnd: (operator.and_, "and"), tree.BitOr: (operator.or_, "or"), tree.BitXor: (operator.xor, "xor"),
    tree.LShift: (operator.lshift, "lshift"), tree.RShift: (operator.rshift, "rshift")}
_UNARY = {"USub": (operator.neg, "neg"), "UAdd": (operator.pos, "pos"), "Invert": (operator.invert, "invert")}
_TEXT_OR_NUMBER = (bool, int, float, complex, str, tuple)


@expression("UnaryOp")
def unary(ev: Evaluator, node: Any, f: Frame) -> Value:
    if isinstance(node.op, tree.Not):
        test = ev.test_of(node.operand, f)
        return Data(tree.at(tree.UnaryOp(node.op, test.node), node), demands=test.demands) if isinstance(
            test, Data) else constant(not test)
    value = ev.value(node.operand, f)
    does, word = _UNARY[type(node.op).__name__]
    if isinstance(value, ObjectValue) and isinstance(value.value, Flag):
        return combined(ev, value.value, does(value.value))
    own = ev.special_method(value, f"__{word}__", node, f)
    if own is not None or isinstance(value, Reference):
        return ev.call(own or ev.attribute_of(value, f"__{word}__", node, f), [], {}, node, f)
    if isinstance(value, Data) and value.is_known and isinstance(value.known, (int, float, complex)):
        known = does(value.known)
        if value.is_literal:
            return Data(tree.at(tree.const(known), node), known)
        return Data(tree.at(tree.UnaryOp(node.op, value.node), node), known)
    refuse_no_number(ev, value, node)
    return Data(tree.at(tree.UnaryOp(node.op, ev.spelled(value, node)), node), demands=demands_of(value),
                shape=broadcast(value), origins=origins(value))


@expression("BinOp")
def binary_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    left, right = ev.values([node.left, node.right], f)
    return binary(ev, node.op, left, right, node, f)


@operation
def binary(ev: Evaluator, op: AST, left: Value, right: Value, node: AST, f: Frame) -> Value:
    """`left op right` of any values."""
    if is_sparse(left, ev.heap) or is_sparse(right, ev.heap):
        return ev.matrix_operator(op, left, right, node)
    for value in (left, right):
        if isinstance(value, ResidualObject) or isinstance(value, Reference) and ev.heap[value].kind == "record" or (
                isinstance(value, TupleValue) and value.made is not None):
            found = _overloaded(ev, OPERATORS[type(op)][1], left, right, node, f)
            if found is not None:
                return found
    if isinstance(left, ObjectValue) and isinstance(right, ObjectValue) and isinstance(left.value, Flag) and (
            type(left.value) is type(right.value)):
        return combined(ev, left.value, OPERATORS[type(op)][0](left.value, right.value))
    opaque = [v for v in (left, right) if isinstance(v, OpaqueValue)]
    if opaque and not any(isinstance(v, Data) and isinstance(v.known, str) for v in (left, right)):
        return opaque[0]
    texts = any(isinstance(v, OpaqueValue) or isinstance(v, Data) and isinstance(v.known, str) for v in (left, right))
    if texts and isinstance(op, (tree.Add, tree.Mod)) and (
            isinstance(op, tree.Mod) or any(isinstance(v, OpaqueValue) for v in (left, right))):
        known = [_text_operand(v) for v in (left, right)]
        if UNKNOWN in known:
            return OpaqueValue(demands=demands_of(left, right))
    for value in (left, right) if texts else ():
        if isinstance(value, Data) and not value.is_known and value.demands:
            raise ev.unknown(node, "what a text is joined with must be known before the run", value)
    found = ev.container_operator(op, left, right, node, f)
    if found is not None:
        return found
    demands = demands_of(left, right)
    if isinstance(left, Data) and isinstance(right, Data) and left.is_known and right.is_known:
        known = computed(OPERATORS[type(op)][0], left.known, right.known)
        if known is not UNKNOWN:
            whole = isinstance(known, float) and isinstance(left.known, int) and isinstance(right.known, int)
            if left.is_literal and right.is_literal or isinstance(known, (str, tuple)) or (
                    whole and isinstance(op, tree.Pow)):        # integers of compiled code have no such power
                return Data(tree.at(tree.const(known), node), known)
            return Data(tree.at(tree.BinOp(left.node, op, right.node), node), known, demands)
    ev.refuse_objects((left, right), node)
    for value, operand in ((left, "left"), (right, "right")):
        refuse_no_number(ev, value, getattr(node, operand, node))
    if isinstance(op, tree.Pow) and isinstance(right, Data) and right.is_signed:     # an array's integers have no such
        right = Data(tree.call(ev.library("builtins.float"), ev.spelled(right, node)), shape=right.shape)
    rows = [_as_row(ev, v) for v in (left, right)]
    found_shape = of_call("numpy.matmul", rows, {}) if isinstance(op, tree.MatMult) else broadcast(*rows)
    return Data(tree.at(tree.BinOp(ev.spelled(left, node), op, ev.spelled(right, node)), node), demands=demands,
                shape=found_shape, origins=origins(left, right),
                is_list=_gives_list(op, left, right))


def _gives_list(op: AST, left: Value, right: Value) -> bool:
    """Whether an operator gives a list, of one of unknown length: of two it joins them, an integer repeats one. An
    array makes an array of it."""
    lists = [isinstance(v, Data) and v.is_list for v in (left, right)]
    if isinstance(op, tree.Mult):
        return any(lists) and any(shape(v) == () for v in (left, right))
    return isinstance(op, tree.Add) and any(lists) and all(
        known or not isinstance(v, Data) for known, v in zip(lists, (left, right)))


def _as_row(ev: Evaluator, value: Value) -> Value:
    """An operand; a sequence of numbers as the array that NumPy makes of it."""
    items = value.items if isinstance(value, TupleValue) else list(ev.heap[value].items.values()) if isinstance(
        value, Reference) and ev.heap[value].kind == "list" else ()
    return Data(tree.const(None), shape=(len(items),)) if items and all(shape(i) == () for i in items) else value


def _text_operand(value: Value) -> Any:
    if isinstance(value, TupleValue):
        items = [_text_operand(i) for i in value.items]
        return UNKNOWN if UNKNOWN in items else tuple(items)
    return value.known if isinstance(value, Data) else UNKNOWN


@operation
def none_here(ev: Evaluator, value: Value, node: AST, inner: bool = True) -> S2sadError:
    """What is said where None is used; where only some runs come here these raise what Python raises."""
    named = ev.subject(value, node, inner)
    said = named.strip("'") if named.startswith("'") else "..."
    what = f"{named if said != '...' else 'this'} is None here"
    if not ev.is_sure():
        ev.raises("builtins.TypeError", [tree.const(what)], node)
    return ev.refusal(node, what, code="S203",
                      help=f"test it before: if {said} is not None: ...")


@operation
def refuse_no_number(ev: Evaluator, value: Value, node: AST) -> None:
    """Refuses None and texts where numbers and arrays are computed with."""
    if isinstance(value, Data) and value.is_known and value.known is None:
        raise none_here(ev, value, node, inner=False)
    if isinstance(value, OpaqueValue) or isinstance(value, Data) and isinstance(value.known, str):
        raise ev.refusal(node, "this is a text here, and it is computed with", code="S203")


def computed(does: Callable[..., Any], *known: Any) -> Any:
    """A constant of constants; UNKNOWN where Python would raise, or where the result is none to write down."""
    if not all(isinstance(k, _TEXT_OR_NUMBER) for k in known) or _may_be_huge(does, *known):
        return UNKNOWN
    try:
        found = does(*known)
    except (ArithmeticError, TypeError, ValueError):
        return UNKNOWN
    if isinstance(found, float) and not abs(found) < float("inf") or isinstance(found, int) and abs(found) >= 2 ** 62:
        return UNKNOWN
    return found if isinstance(found, _TEXT_OR_NUMBER) else UNKNOWN


def _may_be_huge(does: Callable[..., Any], left: Any = 0, right: Any = 0, *_: Any) -> bool:
    """Whether computing a result may take more than a number of 64 bits does."""
    if does in (operator.pow, operator.lshift):
        return isinstance(left, int) and isinstance(right, int) and abs(right) * max(abs(left).bit_length(), 1) > 128
    return does is operator.mul and any(isinstance(k, (str, tuple)) for k in (left, right)) and any(
        type(k) is int and k > 10_000 for k in (left, right))


def _overloaded(ev: Evaluator, word: str, left: Value, right: Value, node: AST, f: Frame, reflected: str = "r"
                ) -> Value | None:
    """An operator of a class of the user's: the left one's, or the right one's for exchanged operands."""
    for value, other, name in in_order(ev, left, right, f"__{word}__", f"__{reflected}{word}__"):
        method = ev.special_method(value, name, node, f)
        if method is not None and value is right and not _gives_way(ev, left, right, node, f):
            raise ev.refusal(node, "an operator with an object on its right, and on its left what may be a number or "
                             "an array of NumPy's, which would not ask its class", help="put the object on the left")
        found = answered(ev, method, other, node, f)
        if found is not None:
            return found
    return None


@operation
def in_order(ev: Evaluator, left: Value, right: Value, word: str, reflected: str) -> list[tuple[Value, Value, str]]:
    """The operands in the order in which Python asks their classes: a class that is derived from the other's first."""
    ways = [(left, right, word), (right, left, reflected)]
    classes = [ev.class_of(v) for v in (left, right)]
    derived = None not in classes and classes[0] != classes[1] and classes[0] in ev.mro(classes[1])
    return ways[::-1] if derived else ways


@operation
def answered(ev: Evaluator, method: Value | None, other: Value, node: AST, f: Frame) -> Value | None:
    """What an operator's method gives; None where there is none, or it is NotImplemented."""
    found = None if method is None else ev.call(method, [other], {}, node, f)
    return None if isinstance(found, LibraryValue) and found.path == "builtins.NotImplemented" else found


def _gives_way(ev: Evaluator, left: Value, right: Value, node: AST, f: Frame) -> bool:
    """Whether what is on the left has the class on the right asked: a number does, be it Python's or NumPy's."""
    if not isinstance(left, Data) or left.is_known:
        return True
    return left.shape == () and not ev.is_sequence(ev.class_of(right), node, f)
