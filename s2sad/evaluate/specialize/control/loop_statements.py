"""for, while, break, continue, return: a loop stays one if nothing in it must be known, else it is written out.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.sequences.constant_tables import lists_in
from s2sad.evaluate.specialize.sequences.cursors import Known
from s2sad.evaluate.specialize.sequences.generators import is_lazy
from s2sad.evaluate.specialize.sequences.known_shapes import item_like, like_items
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation, statement
from s2sad.evaluate.specialize.signals import NOWHERE, Leave, Unevaluated
from s2sad.evaluate.specialize.heap import Temporary
from s2sad.evaluate.specialize.control.first_iteration import Split, peeled, split_iteration
from s2sad.evaluate.specialize.control.residual_loops import ResidualLoop
from s2sad.evaluate.specialize.values import NONE, Data, Iteration, TupleValue, Value, alike
from s2sad.evaluate.specialize.control.written_out_loops import WhileCursor
from s2sad.tree import AST


@statement("While")
def while_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    def stays() -> None:
        def once() -> Callable[[list[AST]], AST]:
            before = ev.snapshot()
            test = ev.test_of(s.test, f)
            if isinstance(test, bool) and not test:
                raise ev.unknown(s.test, "a loop ends here")
            plain = not ev.has_acted(before)
            node = test.node if isinstance(test, Data) else tree.const(True)
            loop = ev.loops[-1]
            if not plain and isinstance(test, Data):        # the test has statements of its own
                jump = tree.at(tree.Break(), s)
                ev.emit(tree.If(tree.UnaryOp(tree.Not(), node), [jump], []), s)
                loop.exits.append((jump, ev.block[-1].body, ev.heap.fork()))
                node = tree.const(True)
            loop.is_endless = isinstance(node, tree.Constant)
            loop.make = lambda body: tree.While(node, body, [])
            ev.statements(s.body, f)
            return loop.make
        ev.residual_loop(s, once, f)
        if s.orelse:
            raise ev.refusal(s, "else of a loop that stays one is not supported in a kernel",
                             help="keep a flag, and test it behind the loop")
    known = test_known(ev, s, f)
    if known is False:
        ev.statements(s.orelse, f)
        return

    def peel() -> None:
        test = ev.test_of(s.test, f)
        tests = (ev.named(test, "runs", s.test).node,) if isinstance(test, Data) else ()
        peeled(ev, s, f, Split(NONE, NONE, tests), lambda: rolled(ev, s, stays), lambda _: None)
    unroll = (lambda: ev.unrolled(s, WhileCursor(ev, s, f), f, lambda _: None)) if known else None
    rolled(ev, s, stays, peel, unroll)


def test_known(ev: Evaluator, s: Any, f: Frame) -> bool | None:
    """The test of a loop before its first round, None where it is not known."""
    before = ev.snapshot()
    test = ev.test_of(s.test, f)
    ev.restore(before)
    return None if isinstance(test, Data) else test


def rolled(ev: Evaluator, s: Any, *forms: Callable[[], Any] | None) -> None:
    """A loop as it stands; where something in it must be known, it is taken back, and evaluated in the next form."""
    before = ev.snapshot()
    pending, loops, guarded = list(ev.pending), list(ev.loops), ev.guarded
    outer = ev.block
    why: Unevaluated | None = None
    for form in forms:
        if form is None or why is not None and not why.differs and form is not forms[-1]:
            continue
        try:
            form()
            return
        except Unevaluated as reason:
            ev.pending[:], ev.loops[:] = pending, loops
            ev.block, ev.guarded = outer, guarded
            ev.restore(before)
            why = reason if why is None or _tells_more(ev, reason, why) else why
    assert why is not None
    raise why from None


def _tells_more(ev: Evaluator, reason: Unevaluated, other: Unevaluated) -> bool:
    """Which of two reasons is better acted on: a list that can be residual, facts that can be asked, the last one."""
    if ev.unrolls or other.site is None:
        return bool(reason.demands) or not other.demands
    return False


@statement("For")
def for_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    whole = ev.value(s.iter, f)
    if not isinstance(whole, Iteration) or whole.kind != "range":       # a range that stays is read as it is
        whole = ev.atoms(whole, "iterated", s.iter)
    ev.used(whole, s.iter)
    if is_lazy(whole):
        ev.for_lazy(s, whole, f)
        return
    slot = Temporary("iterated", id(s))

    def bind(item: Value) -> None:
        ev.store(s.target, item, f)

    def held() -> Value:
        through = ev.atoms(whole, "iterated", s.iter)
        ev.heap.put(f.reference, slot, through)      # its names are in use
        return through

    def unroll() -> None:
        cursor = ev.cursor_of(held(), s.iter, f)
        if isinstance(cursor, Known):       # the names of what is to come are in use
            ev.heap.put(f.reference, slot, TupleValue(cursor.items))
        ev.unrolled(s, cursor, f, bind)

    def peel() -> None:
        split = split_iteration(ev, held(), s.iter)
        if split is None:
            raise ev.unknown(s, "the first round of a loop differs from the others")
        ev.heap.put(f.reference, slot, TupleValue((split.first, split.rest)))
        peeled(ev, s, f, split, lambda: rolled(ev, s, lambda: for_stays(ev, s, split.rest, f)), bind)

    def stays() -> None:
        lists = lists_in(ev, whole)
        for_stays(ev, s, tables, f)
        if any(len(before) != len(ev.heap.objects[n].items) or not all(
                map(alike, before.values(), ev.heap.objects[n].items.values())) for n, before in lists):
            raise ev.unknown(s.iter, "a list is changed by the loop that goes through it")

    tables = ev.through_tables(whole, s.iter)
    if ev.stays_one(tables):
        rolled(ev, s, stays, peel, unroll)
    else:
        unroll()
    items = dict(ev.heap[f.reference].items)
    items.pop(slot, None)
    ev.heap.set_items(f.reference, items)


def for_stays(ev: Evaluator, s: Any, through: Value, f: Frame) -> None:
    """A loop over numbers and arrays that stays one."""
    if s.orelse:
        raise ev.unknown(s, "else of a loop that stays one is not supported in a kernel")
    names = [n.id for n in tree.walk(s.target) if isinstance(n, tree.Name)]
    if not all(isinstance(n, (tree.Name, tree.Tuple, tree.List)) for n in tree.walk(s.target)):
        raise ev.unknown(s.target, "a loop over items of a structure")
    own: dict[str, str] = {}
    node = ev.spelled(through, s.iter)
    items = like_items(s.target, item_like(through))

    def placed(n: str, like: Value) -> Value:
        """A name for what a round takes, for each item of what is a tuple."""
        if isinstance(like, TupleValue):
            return TupleValue(tuple(placed(f"{n}_{k}", i) for k, i in enumerate(like.items)))
        own.setdefault(n, before.get(n) or ev.fresh(n))
        assert isinstance(like, Data)
        return replace(like, node=tree.at(tree.name(own[n]), s.target))

    def once() -> Callable[[list[AST]], AST]:
        found = {n: placed(n, items.get(n, Data(tree.const(None)))) for n in names}
        for n, value in found.items():
            ev.heap.put(f.reference, n, value)
        target = tree.rebuild(s.target, lambda n: ev.spelled(found[n.id], n) if isinstance(n, tree.Name) else None)
        loop = ev.loops[-1]
        loop.targets = frozenset(own.values())
        loop.make = lambda body: tree.For(tree._target(target), tree.copy(node), body, [], None)
        ev.statements(s.body, f)
        return loop.make
    held = ev.heap[f.reference].items
    before = {n: v.name for n in names if isinstance(v := held.get(n), Data) and ev.owns(v.name)}
    ev.rebound += before.values()
    ev.heap.set_items(f.reference, {k: v for k, v in held.items() if k not in names})
    ev.residual_loop(s, once, f)


@statement("Break")
def break_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    _jump(ev, s, 0)


@statement("Continue")
def continue_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    _jump(ev, s, 1)


def _jump(ev: Evaluator, s: AST, which: int) -> None:
    loop = ev.loops[-1]
    if isinstance(loop, ResidualLoop):
        jump = tree.at(tree.Continue() if which else tree.Break(), s)
        ev.emit(jump, s)
        loop.exits.append((jump, ev.block, ev.heap.fork()))
        raise Leave(NOWHERE)
    ev.leave(s, loop[which], None)


@statement("Return")
def return_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    leave_function(ev, s, NONE if s.value is None else ev.value(s.value, f), f)


@operation
def leave_function(ev: Evaluator, s: Any, value: Value, f: Frame) -> None:
    """A return of a value."""
    if f.is_entry:
        ev.returns(s, value, f)
        raise Leave(NOWHERE)
    ev.leave(s, f.mark, ev.atoms(value, "result", s))
