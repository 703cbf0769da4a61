"""Decisions: a statement that reads one of several things is evaluated once for each.

    if hit is not None:        if which == 0: pass                    which of them a slot holds, a test of the
        s += hit.mass          else: s += sun_mass                    residual program tells; behind it all is as before
"""
from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.choice_joins import restricted
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.heap import Temporary
from s2sad.evaluate.specialize.signals import Undecided, Unevaluated
from s2sad.evaluate.specialize.values import (
    Choice, Data, Iteration, MethodValue, Reference, ResidualObject, SliceValue, TupleValue, Value, alike, parts,
    with_parts,
)
from s2sad.tree import AST

_MOST = 1000        # evaluations of statements for one of several things: a statement that reads two of n has n**2


def decided(ev: Evaluator, s: AST, run: Callable[[], None], f: Frame) -> None:
    """Evaluates a statement, again for each alternative of a choice that it reads."""
    if not ev.choices:
        run()
        return
    before, pending, loops = ev.snapshot(), list(ev.pending), list(ev.loops)
    outer, guarded, depth, since = ev.block, ev.guarded, ev.depth, (ev.emitted, ev.heap.changes)
    try:
        run()
    except Undecided as found:
        ev.pending[:], ev.loops[:] = pending, loops
        ev.block, ev.guarded, ev.depth = outer, guarded, depth
        ev.restore(before)
        slot = None if _is_held(ev, found.choice) else _hold(ev, s, found, since, f)
        _each(ev, found.choice, lambda: decided(ev, s, run, f), found.node)
        if slot is not None:
            ev.heap.set_items(f.reference, {k: v for k, v in ev.heap[f.reference].items.items() if k != slot})


def _hold(ev: Evaluator, s: AST, found: Undecided, since: tuple[int, int], f: Frame) -> Temporary:
    """The slot that holds what an expression gives, before its statement, of which it is the first to be evaluated."""
    slot = Temporary("decided", id(found.node))
    first = found.since == since and any(n is found.node for n in tree.walk(s)) and type(s).__name__ != "While"
    if not first or slot in ev.heap[f.reference].items:
        raise Unevaluated(ev.refusal(
            found.node, "this is one of several things, and only the run knows which",
            help="give it a name before this statement, and ask what it is: if x is not None"))
    value = ev.carried(found.node, f)
    ev.heap.put(f.reference, slot, value)
    if not (isinstance(value, Choice) and alike(value, found.choice)):
        raise ev.refusal(found.node, "this is one of several things, and only the run knows which",
                         help="give it a name before this statement")
    return slot


def _each(ev: Evaluator, choice: Choice, run: Callable[[], None], origin: AST) -> None:
    """The statement for each alternative of a choice."""
    first, numbers = choice.values[0], choice.numbers

    def one() -> None:
        around, slots = ev.found_none, _put(ev, choice, first)
        if isinstance(first, Data) and first.is_known and first.known is None:
            ev.found_none = around | slots
        try:
            run()
        finally:
            ev.found_none = around

    def others() -> None:
        _put(ev, choice, rest)
        _each(ev, rest, run, origin)
    if len(numbers) == 1:
        one()
        return
    ev.decisions += 1
    if ev.decisions > _MOST:
        raise ev.refusal(
            origin, f"statements that read one of several things would be evaluated over {_MOST} times, once for each "
            "combination", help="read of each what is needed into arrays or numbers first")
    rest = restricted(choice, numbers[1:])
    test = tree.compare(ev.spelled(choice.number, origin), tree.Eq(), tree.const(numbers[0]))
    ev.branch(Data(tree.at(test, origin), demands=choice.number.demands), (one, others), origin, choice)


def _is_held(ev: Evaluator, choice: Choice) -> bool:
    return any(_with(v, choice, choice) is not None
               for held in ev.heap.objects.values() if held.has_choices for v in held.items.values())


def _put(ev: Evaluator, choice: Choice, value: Value) -> frozenset[tuple[int, Hashable]]:
    """All slots that hold a choice hold one of its alternatives; which these are."""
    value, slots = bound_throughout(ev, value), set[tuple[int, Hashable]]()
    for n, held in [(n, held) for n, held in ev.heap.objects.items() if held.has_choices]:
        new = {k: made for k, v in held.items.items() if (made := _with(v, choice, value)) is not None}
        if new:
            ev.heap.objects[n] = replace(held, items={**held.items, **new})
            slots |= {(n, k) for k in new}
    return frozenset(slots)


def bound_throughout(ev: Evaluator, value: Value) -> Value:
    """A value that is there, and so is all that is in it."""
    if isinstance(value, Data):
        return replace(value, may_be_unbound=False)
    if isinstance(value, Choice):
        return replace(value, number=bound_throughout(ev, value.number))
    if isinstance(value, (TupleValue, ResidualObject)):
        return with_parts(value, [bound_throughout(ev, v) for v in parts(value)])
    if isinstance(value, Reference) and any(
            isinstance(v, Choice) or isinstance(v, Data) and v.may_be_unbound for v in ev.heap[value].items.values()):
        items = {k: bound_throughout(ev, v) if isinstance(v, (Choice, Data)) else v
                 for k, v in ev.heap[value].items.items()}
        ev.heap.objects[value.number] = replace(ev.heap[value], items=items)
    return value


def _with(held: Value, choice: Choice, value: Value) -> Value | None:
    """What a slot holds with a value in place of a choice, None where the choice is not there."""
    if isinstance(held, Choice):
        return value if alike(held, choice) else None
    if not isinstance(held, (TupleValue, Iteration, SliceValue, MethodValue)):
        return None
    name = "base" if isinstance(held, MethodValue) else "items" if isinstance(held, TupleValue) else "parts"
    inner: Any = getattr(held, name)
    items = inner if isinstance(inner, tuple) else (inner,)
    made = [_with(i, choice, value) for i in items]
    if all(m is None for m in made):
        return None
    new = tuple(i if m is None else m for i, m in zip(items, made))
    return replace(held, **{name: new if isinstance(inner, tuple) else new[0]})  # pyright: ignore
