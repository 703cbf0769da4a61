"""Comparisons, identity, membership.
"""
from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import replace
from enum import Flag
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.numeric_operators import computed
from s2sad.evaluate.specialize.control.choices import chosen, is_structural
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression, operation
from s2sad.evaluate.specialize.functions.library_calls import library_call
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.sequences.iterator_use import DEFAULT
from s2sad.evaluate.specialize.sequences.known_shapes import broadcast, shape
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    UNKNOWN, Data, ObjectValue, OpaqueValue, Reference, ResidualObject, TupleValue, Value, alike, constant, demands_of,
)
from s2sad.tree import AST

_COMPARISONS: dict[str, tuple[Callable[[Any, Any], Any], str]] = {
    "Eq": (operator.eq, "eq"), "NotEq": (operator.ne, "ne"), "Lt": (operator.lt, "lt"), "LtE": (operator.le, "le"),
    "Gt": (operator.gt, "gt"), "GtE": (operator.ge, "ge")}


@expression("Compare")
def compare(ev: Evaluator, node: Any, f: Frame) -> Value:
    if len(node.comparators) > 1 and (found := _one_by_one(ev, node, f)) is not None:
        return found
    values = ev.values([node.left, *node.comparators], f)
    if len(values) > 2 and not all(isinstance(v, Data) for v in values):
        raise ev.refusal(node, "a chain of comparisons of structures", help="compare two at a time, joined by and")
    if len(values) > 2:
        pairs = [compared(ev, op, a, b, node, f) for op, a, b in zip(node.ops, values, values[1:])]
        if all(isinstance(p, Data) and p.is_known for p in pairs):
            return constant(all(p.known for p in pairs))  # pyright: ignore
        return Data(tree.at(tree.Compare(ev.spelled(values[0], node), node.ops, [
            ev.spelled(v, node) for v in values[1:]]), node), demands=demands_of(*values))
    return compared(ev, node.ops[0], values[0], values[1], node, f)


def _one_by_one(ev: Evaluator, node: Any, f: Frame) -> Value | None:
    """A chain whose later operands take statements, which are done only where the earlier comparisons hold; None of any
    other."""
    before = ev.snapshot()
    ev.values([node.left, node.comparators[0]], f)
    first = ev.snapshot()
    for operand in node.comparators[1:]:
        ev.value(operand, f)
    plain = not ev.has_acted(first)
    ev.restore(before)
    if plain:
        return None
    left = ev.atoms(ev.value(node.left, f), "left", node)
    return _chain(ev, node, 0, left, f)


def _chain(ev: Evaluator, node: Any, k: int, left: Value, f: Frame) -> Value:
    at, effects, rebound = len(ev.block), ev.effects, len(ev.rebound)
    right = ev.atoms(ev.value(node.comparators[k], f), "operand", node)
    if ev.effects > effects:
        left = ev.held_at(left, at, {*ev.rebound[rebound:]}, node)
    found = compared(ev, node.ops[k], left, right, node, f)
    test = ev.truth(found, node, f)
    if k + 1 == len(node.ops) or test is False:
        return found
    if not isinstance(test, Data):
        return _chain(ev, node, k + 1, right, f)
    kept = ev.named(test, "test", node)
    return chosen(ev, kept, (lambda: _chain(ev, node, k + 1, right, f), lambda: kept), node, f)


@operation
def compared(ev: Evaluator, op: AST, a: Value, b: Value, node: AST, f: Frame) -> Value:
    kind = type(op).__name__
    for v in (a, b):
        ev.refuse_missing(v, node)
    if kind in ("Is", "IsNot"):
        if isinstance(a, ResidualObject) and isinstance(b, ResidualObject):
            return _rows(ev, a, b, kind == "Is", node)
        return constant(_identical(ev, a, b, node) is (kind == "Is"))
    if texts := [v for v in (a, b) if isinstance(v, OpaqueValue)]:
        raise ev.unknown(node, f"{texts[0].what} is compared", texts[0],
                         help="keep a number that says the same, and compare that")
    if kind in ("In", "NotIn"):
        return _contained(ev, a, b, kind == "In", node, f)
    does, word = _COMPARISONS[kind]
    if is_sparse(a, ev.heap) or is_sparse(b, ev.heap):
        ev.refuse_whole(a if is_sparse(a, ev.heap) else b, node)
    if kind not in ("Eq", "NotEq"):         # rows of lists of the run are ordered as tuples are
        a, b = (TupleValue(tuple(ev.items_of(v, node, f))) if _is_row(v) else v for v in (a, b))
    if isinstance(a, Data) and isinstance(b, Data):
        if a.is_known and b.is_known and (kind in ("Eq", "NotEq") or computed(does, a.known, b.known) is not UNKNOWN):
            return constant(does(a.known, b.known))
        if kind in ("Eq", "NotEq") and any(is_structural(v) for v in (a, b)) and any(not v.is_known for v in (a, b)):
            other = a if not a.is_known else b
            if other.demands:
                raise ev.unknown(node, "what is compared with a text must be known before the run", other)
            return constant(kind == "NotEq")        # a number or an array is no text
        for v in (a, b):
            if v.is_known and v.known is None:
                raise ev.none_here(v, node)
        ev.refuse_objects((a, b), node)
        return Data(tree.at(tree.Compare(ev.spelled(a, node), [op], [ev.spelled(b, node)]), node),
                    demands=demands_of(a, b), shape=broadcast(a, b) or None)
    found = _overloaded_comparison(ev, word, a, b, node, f)
    if found is not None:
        return found
    a, b = (TupleValue(tuple(map(constant, v.known))) if isinstance(v, Data) and isinstance(
        v.known, tuple) else v for v in (a, b))
    if any(isinstance(v, Data) and v.shape for v in (a, b)) and any(map(ev.is_spelled_out, (a, b))):
        return Data(tree.at(tree.Compare(ev.spelled(a, node), [op], [ev.spelled(b, node)]), node),
                    demands=demands_of(a, b), shape=broadcast(a, b))
    if isinstance(a, ResidualObject) and isinstance(b, ResidualObject) and kind in ("Eq", "NotEq"):
        return _rows(ev, a, b, kind == "Eq", node)
    if isinstance(a, TupleValue) and isinstance(b, TupleValue):
        return _tuples(ev, op, a, b, node, f)
    if kind in ("Eq", "NotEq"):
        if isinstance(a, Data) and not a.is_known or isinstance(b, Data) and not b.is_known:
            if isinstance(a, TupleValue) or isinstance(b, TupleValue):
                return Data(tree.at(tree.Compare(ev.spelled(a, node), [op], [ev.spelled(b, node)]), node),
                            demands=demands_of(a, b))
        if isinstance(a, Reference) and isinstance(b, Reference) and ev.heap[a].kind in ("list", "dict", "set"):
            return _containers(ev, op, a, b, node, f)
        same = _identical(ev, a, b, node)
        return constant(same is (kind == "Eq"))
    if any(isinstance(v, Data) and v.shape == () for v in (a, b)) and any(map(ev.is_spelled_out, (a, b))):
        raise ev.refusal(node, "a number is compared with a list or tuple that is spelled out",
                         help="make it an array: np.array([...])")
    refused = ev.refusal(node, f"{ev.kind_of(a)} and {ev.kind_of(b)} are compared")
    raise Unevaluated(refused, demands_of(a, b)) if demands_of(a, b) else refused


def _is_row(value: Value) -> bool:
    """Whether a value is a tuple of the run's, which is no shape."""
    return isinstance(value, Data) and bool(value.count) and not value.is_known and not isinstance(
        value.node, tree.Attribute)


@operation
def is_spelled_out(ev: Evaluator, value: Value) -> bool:
    """Whether a value is a list or a tuple."""
    return isinstance(value, TupleValue) and value.made is None or isinstance(
        value, Reference) and ev.heap[value].kind == "list"


def _overloaded_comparison(ev: Evaluator, word: str, a: Value, b: Value, node: AST, f: Frame) -> Value | None:
    """A comparison that a class of the user's defines; `!=` is the inverse of `==` where only that is defined."""
    reflected = {"lt": "gt", "gt": "lt", "le": "ge", "ge": "le"}.get(word, word)
    for value, other, name in ev.in_order(a, b, f"__{word}__", f"__{reflected}__"):
        found = ev.answered(ev.special_method(value, name, node, f), other, node, f)
        if found is None and word == "ne":
            equal = ev.answered(ev.special_method(value, "__eq__", node, f), other, node, f)
            test = None if equal is None else ev.truth(equal, node, f)
            if test is not None:
                return Data(tree.at(tree.UnaryOp(tree.Not(), test.node), node)) if isinstance(
                    test, Data) else constant(not test)
        if found is None and word in ("eq", "ne") and ev.compares_fields(value):
            if ev.class_of(a) != ev.class_of(b):
                continue
            pairs = [TupleValue(ev.compared_fields(v, node, f)) for v in (a, b)]
            return _tuples(ev, tree.Eq() if word == "eq" else tree.NotEq(), pairs[0], pairs[1], node, f)
        if found is not None:
            return found
    return None


def _rows(ev: Evaluator, a: ResidualObject, b: ResidualObject, wanted: bool, node: AST) -> Value:
    """Whether two objects of tables are one and the same."""
    if a.table is not b.table or alike(a, b):
        return constant((a.table is b.table) is wanted)
    op = tree.Eq() if wanted else tree.NotEq()
    return Data(tree.at(tree.Compare(ev.spelled(a.number, node), [op], [ev.spelled(b.number, node)]), node), shape=())


def _tuples(ev: Evaluator, op: AST, a: TupleValue, b: TupleValue, node: AST, f: Frame) -> Value:
    does = _COMPARISONS[type(op).__name__][0]
    known = [[i.known if isinstance(i, Data) and i.is_known else UNKNOWN for i in t.items] for t in (a, b)]
    if not any(k is UNKNOWN for t in known for k in t):
        return constant(does(tuple(known[0]), tuple(known[1])))
    if len(a.items) != len(b.items) and type(op).__name__ in ("Eq", "NotEq"):
        return constant(type(op).__name__ == "NotEq")
    return Data(tree.at(tree.Compare(ev.spelled(a, node), [op], [ev.spelled(b, node)]), node),
                demands=demands_of(*a.items, *b.items))


def _containers(ev: Evaluator, op: AST, a: Reference, b: Reference, node: AST, f: Frame) -> Value:
    """Whether two lists, dicts or sets are equal."""
    wanted = type(op).__name__ == "Eq"
    one, other = ev.heap[a], ev.heap[b]
    if one.kind != other.kind or {*one.items} != {*other.items}:
        return constant(not wanted)
    tests: list[AST] = []
    for key in one.items if one.kind != "set" else ():
        test = ev.truth(compared(ev, tree.Eq(), one.items[key], other.items[key], node, f), node, f)
        if isinstance(test, Data):
            tests.append(ev.spelled(test, node))
        elif not test:
            return constant(not wanted)
    if not tests:
        return constant(wanted)
    equal = tests[0] if len(tests) == 1 else tree.BoolOp(tree.And(), tests)
    return Data(tree.at(equal if wanted else tree.UnaryOp(tree.Not(), equal), node))


def _identical(ev: Evaluator, a: Value, b: Value, node: AST) -> bool:
    """`a is b`."""
    datas = [v for v in (a, b) if isinstance(v, Data)]
    if len(datas) == 2 and not (datas[0].is_known and datas[1].is_known):
        known = [v for v in datas if v.is_known]
        if known and (known[0].known is None or isinstance(known[0].known, (str, bool))):
            other = next(v for v in datas if not v.is_known)
            if isinstance(known[0].known, bool) and not other.shape:    # a bool of NumPy's is neither
                raise ev.unknown(node, f"whether something is {known[0].known} is asked, which only the run knows",
                                 other, help="test it as it is: if flag, or if not flag")
            if other.demands and (isinstance(known[0].known, (str, bool)) or other.shape is None):
                raise ev.unknown(node, "what an object is must be known before the run", other)
            return False
        if datas[0].name and datas[0].name == datas[1].name:
            return True
        if all(v.name in ev.paths for v in datas):
            return _are_one(ev, ev.paths[datas[0].name], ev.paths[datas[1].name], node)
        raise ev.refusal(node, "whether two arrays are one and the same is asked", help="keep a flag")
    if len(datas) == 2:
        return datas[0].known is datas[1].known or (
            type(datas[0].known) is type(datas[1].known) and datas[0].known == datas[1].known)
    if isinstance(a, ObjectValue) and isinstance(b, ObjectValue):
        return a.value is b.value
    if is_sparse(a, ev.heap) and is_sparse(b, ev.heap) and a != b:
        raise ev.refusal(node, "whether two sparse matrices are one and the same is asked", help="keep a flag")
    if isinstance(a, Reference) and isinstance(b, Reference) and a != b and ev.heap[a].kind == ev.heap[b].kind:
        paths = [ev.heap[r].path for r in (a, b)]
        if all(paths):
            return _are_one(ev, paths[0], paths[1], node)
        if all(map(ev.is_listed, (a, b))):
            raise ev.rows_wanted(ev.in_lists[a.number] | ev.in_lists[b.number], ev.refusal(
                node, "whether two objects of a list are one and the same is asked, whose length only the run knows",
                help="compare what tells them apart: a.number == b.number"))
        if any(paths) and any(ev.heap[r].live is not None for r in (a, b)):
            raise ev.refusal(node, "whether an object that is given is one from outside is asked", help="keep a flag")
    return len(datas) == 0 and alike(a, b)


def _are_one(ev: Evaluator, path: str, other: str, node: AST) -> bool:
    """Whether two places of the arguments hold one object."""
    fact = (path, f"is {other}")
    if fact not in ev.facts:
        raise ev.unknown(node, "whether two objects are one and the same is asked", Data(
            tree.const(None), demands=frozenset((fact,))))
    return bool(ev.facts[fact])


def _contained(ev: Evaluator, a: Value, b: Value, wanted: bool, node: AST, f: Frame) -> Value:
    own = ev.special_method(b, "__contains__", node, f) if isinstance(b, TupleValue) else None
    if own is not None:
        raise ev.refusal(node, "'in' of a named tuple, whose class defines '__contains__'", help="call its method")
    if isinstance(b, Reference) and ev.heap[b].kind in ("dict", "set"):
        if isinstance(a, Data) and a.shape == () and not a.is_known and not a.demands:
            return _is_a_key(ev, a, b, wanted, node)
        return constant((ev.key_of(a, node) in ev.heap[b].items) is wanted)
    if isinstance(b, Reference) and ev.heap[b].kind == "record" or isinstance(b, ResidualObject) and (
            b.table.kind == "record"):
        found = ev.truth(ev.call(ev.attribute_of(b, "__contains__", node, f), [a], {}, node, f), node, f)
        if isinstance(found, Data):
            return found if wanted else Data(tree.at(tree.UnaryOp(tree.Not(), found.node), node))
        return constant(found is wanted)
    if isinstance(a, ResidualObject) and isinstance(b, Data) and b.is_list:
        if ev.special_method(a, "__eq__", node, f) is not None or ev.compares_fields(a):
            raise ev.refusal(node, "'in' compares objects, whose class says what equal is", help="write a loop")
        if not ev.may_hold(b, a.table):
            return constant(not wanted)
        a, b = a.number, replace(b, rows=None)
    if isinstance(b, Data) and isinstance(b.known, str):
        return constant((ev.known(a, node, "a part of a text") in b.known) is wanted)
    if isinstance(b, Data) and (b.demands or shape(b) == ()):       # what is given may be a set; a number
        raise ev.refusal(node, "whether an array has an element is asked", help="write np.any(a == x)")
    if isinstance(b, Data) and isinstance(a, Data) and not (a.is_known and isinstance(a.known, (str, type(None)))):
        found = library_call(ev, "numpy.any", [library_call(ev, "numpy.equal", [b, a], {}, node, f)], {}, node, f)
        return found if wanted else Data(tree.at(tree.UnaryOp(tree.Not(), ev.spelled(found, node)), node))
    if isinstance(b, Data):
        raise ev.rows_wanted(ev.made_at(a), ev.refusal(
            node, "whether an array has an element that is no number is asked", help="compare numbers"))
    if isinstance(a, ObjectValue) and isinstance(b, ObjectValue) and isinstance(b.value, Flag):
        return constant((a.value in b.value) is wanted)
    before = ev.snapshot()
    found = _any_equal(ev, a, b, node, f)
    if ev.has_acted(before):        # Python asks no further than the first that is equal
        ev.restore(before)
        found = ev.truth(ev.first_item(b, node, f, lambda item: tree.If(
            _is_or_equals(item, isinstance(a, Reference)), [tree.Return(tree.const(True))], []),
            tree.Return(tree.const(False)), a), node, f)
    if isinstance(found, bool):
        return constant(found is wanted)
    return found if wanted else Data(tree.at(_negated(found.node), node), demands=found.demands)


def _is_a_key(ev: Evaluator, a: Data, b: Reference, wanted: bool, node: AST) -> Value:
    """Whether a number that only the run knows is a key: which keys there are is known."""
    tests: list[AST] = [tree.Compare(ev.spelled(a, node), [tree.Eq()], [tree.const(key)]) for key in ev.heap[b].items
                        if isinstance(key, (int, float))]
    if not tests:
        return constant(not wanted)
    test = tests[0] if len(tests) == 1 else tree.BoolOp(tree.Or(), tests)
    return Data(tree.at(test if wanted else _negated(test), node), shape=())


def _is_or_equals(item: AST, may_be: bool) -> AST:
    tests = [tree.Compare(item, [op], [tree.name(DEFAULT)]) for op in (tree.Is(), tree.Eq())]
    return tree.BoolOp(tree.Or(), tests) if may_be else tests[1]


def _any_equal(ev: Evaluator, a: Value, b: Value, node: AST, f: Frame) -> bool | Data:
    """Whether one of the items is, or is equal to, a value."""
    tests: list[AST] = []
    for item in b.items if isinstance(b, TupleValue) else ev.items_of(b, node, f):
        found = constant(True) if isinstance(item, Reference) and item == a else compared(
            ev, tree.Eq(), item, a, node, f)
        test = ev.truth(found, node, f)
        if test is True:
            return True
        if isinstance(test, Data):
            tests.append(ev.spelled(test, node))
    if not tests:
        return False
    return Data(tree.at(tests[0] if len(tests) == 1 else tree.BoolOp(tree.Or(), tests), node), demands=demands_of(a))


def _negated(test: AST) -> AST:
    """A test that holds where one does not: comparisons of their own are turned around."""
    if isinstance(test, tree.BoolOp) and isinstance(test.op, tree.Or):
        return tree.BoolOp(tree.And(), [_negated(v) for v in test.values])
    if isinstance(test, tree.Compare) and len(test.ops) == 1 and isinstance(test.ops[0], tree.Eq):
        return tree.Compare(test.left, [tree.NotEq()], test.comparators)
    return tree.UnaryOp(tree.Not(), test)
