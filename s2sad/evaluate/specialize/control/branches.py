"""Branches: what is known is followed; a residual `if` joins its ways.

A branch that is left on some ways (`return`, `break` in what is written out) takes the work that is pending up to where
these ways go into the others: there all of them meet.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Flag
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.choices import boolean_of
from s2sad.evaluate.specialize.control.decisions import decided
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, STATEMENTS, operation, statement
from s2sad.evaluate.specialize.signals import NOWHERE, Leave
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.control.joined_names import Way
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.control.state_joins import Join
from s2sad.evaluate.specialize.values import FACTORY, NONE, Choice, Data, ObjectValue, Reference, TupleValue, Value
from s2sad.tree import AST

Objects = dict[int, Object]


@operation
def statements(ev: Evaluator, block: Sequence[AST], f: Frame) -> None:
    """A block, statement by statement; what follows each is pending while it is evaluated."""
    for k, s in enumerate(block):
        transfer = STATEMENTS.get(type(s).__name__)
        if transfer is None:
            ev.value(s, f)      # which refuses it
            continue
        rest = block[k + 1:]
        ev.later(lambda rest=rest: statements(ev, rest, f))
        depth = len(ev.pending)
        try:
            decided(ev, s, lambda transfer=transfer, s=s: transfer(ev, s, f), f)
        finally:
            del ev.pending[depth - 1:]


# -- branches --------------------------------------------------------------------------------------------------------
@operation
def truth(ev: Evaluator, value: Value, node: AST, f: Frame) -> bool | Data:
    """True or False, or the test that the residual program makes."""
    if isinstance(value, Data):
        return bool(value.known) if value.is_known else value
    if isinstance(value, ObjectValue) and isinstance(value.value, Flag):
        return bool(value.value)
    ev.refuse_missing(value, node)
    for name in ("__bool__", "__len__"):
        method = ev.special_method(value, name, node, f)
        if method is not None:
            return truth(ev, ev.call(method, [], {}, node, f), node, f)
    if isinstance(value, TupleValue):
        return bool(value.items)
    if is_sparse(value, ev.heap):
        ev.refuse_whole(value, node)
    if isinstance(value, Reference) and ev.heap[value].kind != "record":
        return any(k is not FACTORY for k in ev.heap[value].items)
    return True


@operation
def test_of(ev: Evaluator, node: AST, f: Frame) -> bool | Data:
    """Whether an expression is true; of `and` and `or` that is known where their value is not."""
    is_choice = isinstance(node, tree.BoolOp)
    return truth(ev, boolean_of(ev, node, node.values, f, True) if is_choice else ev.value(node, f), node, f)


def continued(ev: Evaluator, left: Leave | None, depth: int, target: int) -> Leave:
    """Does what is pending from here, or from where `left` goes, up to a mark; gives where that ends."""
    saved, loops = list(ev.pending), list(ev.loops)
    del ev.pending[depth if left is None else left.mark:]
    try:
        while len(ev.pending) > target + 1:
            work = ev.pending.pop()
            if work is None:
                continue
            run, ev.loops[:] = work
            try:
                run()
            except Leave as leave:
                if leave.mark <= target:
                    return leave
                del ev.pending[leave.mark:]
        return Leave(target, NONE)
    finally:
        ev.pending[:], ev.loops[:] = saved, loops


@operation
def branch(ev: Evaluator, test: Data, arms: Sequence[Callable[[], Any]], origin: AST, decided: Choice | None = None
           ) -> None:
    """Both arms of a residual `if` from one state; raises Leave where both leave. They may decide a choice: the
    first for its first value, the second for the others."""
    before, outer, effects, since = ev.heap.fork(), ev.block, ev.effects, ev.births
    depth = len(ev.pending)
    ends: list[tuple[Way, Leave | None]] = []
    ev.guarded = (*ev.guarded, test.demands)
    for arm in arms:
        ends.append(_arm(ev, Way(dict(before), []), arm))
    while True:
        goals = [left.mark for _, left in ends if left is not None and left.mark != NOWHERE]
        if not goals:
            break
        target = min(goals)
        if all(left is not None and left.mark in (NOWHERE, target) for _, left in ends):
            break
        ends = [(way, left) if left is not None and left.mark in (NOWHERE, target)
                else _arm(ev, way, lambda left=left, target=target: _go(ev, left, depth, target)) for way, left in ends]
    ev.guarded = ev.guarded[:-1]
    ev.block = outer
    if decided is not None:
        ends[0][0].alternatives, ends[1][0].alternatives = decided.numbers[:1], decided.numbers[1:]
    going = [(way, left) for way, left in ends if left is None or left.mark != NOWHERE]
    value = None
    if going:
        for way, left in going:
            way.value = left.value if left is not None else None
        join = Join(ev, [way for way, _ in going], origin, test.demands, since, decided)
        ev.heap.objects = join.objects()
        if going[0][1] is not None and len(going) > 1:
            value = join.told(join.meet([left.value or NONE for _, left in going if left is not None], "result"))
            ev.heap.objects.update(join.found)
        elif going[0][1] is not None:
            value = going[0][1].value
    body, orelse = (way.block for way, _ in ends)
    if body or orelse:
        ev.effects += 1
        if not body:
            node = tree.If(tree.UnaryOp(tree.Not(), test.node), orelse, [])
        else:
            node = tree.If(test.node, body, orelse)
        ev.emit(node, origin)
    if not going:
        raise Leave(NOWHERE)
    if going[0][1] is not None:
        raise Leave(going[0][1].mark, value)
    del effects


def _go(ev: Evaluator, left: Leave | None, depth: int, target: int) -> None:
    raise continued(ev, left, depth, target)


def _arm(ev: Evaluator, way: Way, arm: Callable[[], Any]) -> tuple[Way, Leave | None]:
    """One way on: its end, and where it has gone, None for on."""
    ev.heap.objects, ev.block = way.objects, way.block
    left = None
    try:
        arm()
    except Leave as leave:
        left = leave
    return Way(ev.heap.objects, ev.block), left


@statement("If")
def if_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    test = test_of(ev, s.test, f)
    if not isinstance(test, Data):
        statements(ev, s.body if test else s.orelse, f)
    else:
        branch(ev, test, (lambda: statements(ev, s.body, f), lambda: statements(ev, s.orelse, f)), s)
