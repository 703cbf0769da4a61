"""Generator functions: their statements are evaluated where what they yield is asked for.

    def interior(n):                                  for i in range(1, n - 1):
        for i in range(1, n - 1):                         j = i + 1
            yield i, i + 1                   ->           u[i] += x[j]

    for i, j in interior(n):
        u[i] += x[j]
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, expression, operation
from s2sad.evaluate.specialize.signals import Leave
from s2sad.evaluate.specialize.heap import Temporary
from s2sad.evaluate.specialize.values import NONE, Data, Iteration, TupleValue, Value, constant
from s2sad.tree import AST

LAZY = ("generator", "yields")      # what is computed when its turn comes
ITEM = ".item"


def is_generator(definition: Any) -> bool:
    """Whether a function yields."""
    work: list[Any] = list(definition.body) if type(definition).__name__ == "FunctionDef" else []
    while work:
        node = work.pop()
        kind = type(node).__name__
        if kind in ("Yield", "YieldFrom"):
            return True
        if kind not in ("FunctionDef", "ClassDef", "Lambda"):
            work += tree.children(node)
    return False


def is_lazy(value: Value) -> bool:
    """Whether what a loop goes through is computed round by round, by statements of the user's."""
    inner = value.parts if isinstance(value, Iteration) and value.kind not in ("keys", "values", "items") else ()
    return isinstance(value, Iteration) and (value.kind in LAZY or any(map(is_lazy, inner)))


@operation
def each_item(ev: Evaluator, through: Value, node: AST, f: Frame, each: Callable[[Value], None]) -> None:
    """Does something with each item of a generator, while it runs."""
    assert isinstance(through, Iteration)
    if through.kind == "generator":
        comprehension, frame = through.more
        ev.generate(comprehension.generators, frame, lambda g: each(ev.value(comprehension.elt, g)),
                    ev.first_of(through))
    elif through.kind == "yields":
        _run(ev, through, node, each)
    elif through.kind == "enumerate":
        _enumerated(ev, through, node, f, each)
    else:
        raise ev.refusal(node, f"{through.kind}() of a generator, in a loop that may change what it reads",
                         help="make it a list before the loop: list(...)")


def _run(ev: Evaluator, through: Iteration, node: AST, each: Callable[[Value], None]) -> None:
    frame, definition = through.more
    pending, loops, depth = len(ev.pending), len(ev.loops), ev.depth
    handlers = list(ev.handlers)

    def outside(item: Value) -> None:
        """Where the item goes no handler of the generator is around, unless that makes a manager."""
        inner = ev.handlers
        ev.handlers = inner if type(node).__name__ == "With" else list(handlers)
        try:
            each(item)
        finally:
            ev.handlers = inner
    frame = replace(frame, mark=pending, loops=loops, yields=outside)
    ev.depth += 1
    ev.pending.append(None)
    try:
        ev.statements(definition.body, frame)
    except Leave as leave:
        if leave.mark != frame.mark:
            raise
    finally:
        ev.depth = depth
        del ev.pending[pending:]
        del ev.loops[loops:]


def _enumerated(ev: Evaluator, through: Iteration, node: AST, f: Frame, each: Callable[[Value], None]) -> None:
    slot = Temporary("number", id(node))
    ev.heap.put(f.reference, slot, through.parts[1] if through.parts[1:] else constant(0))

    def with_number(item: Value) -> None:
        number = ev.heap[f.reference].items[slot]
        item = ev.atoms(item, "item", node)
        each(TupleValue((number, item)))
        number = ev.heap[f.reference].items[slot]
        assert isinstance(number, Data)
        following = constant(number.known + 1) if number.is_known else Data(tree.at(tree.add(
            ev.spelled(number, node), tree.const(1)), node))
        ev.assign_slot(f.reference, slot, following, "number", node)
    each_item(ev, through.parts[0], node, f, with_number)


@operation
def for_lazy(ev: Evaluator, s: Any, through: Value, f: Frame) -> None:
    """A loop through a generator: its body is evaluated where the generator yields."""
    ev.pending.append(None)
    after, depth = len(ev.pending) - 1, len(ev.loops)
    ev.loops.append((after, after, s, f))

    def otherwise() -> None:
        del ev.loops[depth:]        # a jump in `else` is one of the loop around
        ev.statements(s.orelse, f)
    ev.later(otherwise)

    def each(item: Value) -> None:
        inside = len(ev.loops)
        ev.pending.append(None)
        mark = len(ev.pending) - 1
        ev.loops.append((after, mark))
        try:
            ev.store(s.target, item, f)
            ev.statements(s.body, f)
        except Leave as leave:
            if leave.mark != mark:
                raise
        finally:
            del ev.loops[inside:]
            del ev.pending[mark:]
    try:
        each_item(ev, through, s.iter, f, each)
        del ev.pending[after + 1:]
        otherwise()
    except Leave as leave:
        if leave.mark != after:
            raise
    finally:
        del ev.loops[depth:]
        del ev.pending[after:]


@expression("Yield")
def yield_expression(ev: Evaluator, node: Any, f: Frame) -> Value:
    if f.yields is None:
        raise ev.refusal(node, "yield is not supported here in a kernel", help="append to a list, and return it")
    f.yields(NONE if node.value is None else ev.value(node.value, f))
    return NONE


@expression("YieldFrom")
def yield_from(ev: Evaluator, node: Any, f: Frame) -> Value:
    inner = tree.Expr(tree.Yield(tree.name(ITEM)))
    loop = tree.at(tree.For(tree._target(tree.name(ITEM)), node.value, [inner], [], None), node)
    ev.statements([loop], f)
    return NONE
