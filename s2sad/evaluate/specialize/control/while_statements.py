"""while: a loop stays one if nothing in it must be known, else it is written out.

    while prev is None or g() > 0.0:        while True:
        ...                         ->          if not (prev is None or g() > 0.0): break
                                                ...                 where the test takes statements, or is evaluated
                                                                    for each of several things that `prev` may be
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.first_iteration import Split, peeled
from s2sad.evaluate.specialize.control.loop_statements import rolled
from s2sad.evaluate.specialize.control.written_out_loops import WhileCursor
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, statement
from s2sad.evaluate.specialize.signals import Undecided
from s2sad.evaluate.specialize.values import NONE, Data
from s2sad.tree import AST


@statement("While")
def while_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    def stays() -> None:
        ev.residual_loop(s, lambda: _once(ev, s, f), f)
    known = test_known(ev, s, f)
    if known is False or s.orelse:
        ev.statements(s.orelse, f) if known is False else ev.while_with_else(s, f)
        return

    def peel() -> None:
        test = ev.test_of(s.test, f)
        tests = (ev.named(test, "runs", s.test).node,) if isinstance(test, Data) else ()
        peeled(ev, s, f, Split(lambda: NONE, NONE, tests), lambda: rolled(ev, s, stays), lambda _: None)
    unroll = (lambda: ev.unrolled(s, WhileCursor(ev, s, f), f, lambda _: None)) if known else None
    rolled(ev, s, stays, peel, unroll)


def _once(ev: Evaluator, s: Any, f: Frame) -> Callable[[list[AST]], AST]:
    """A round of a loop that stays; what makes the loop of its body."""
    loop, test = ev.loops[-1], _test_alone(ev, s, f)
    if test is False:
        raise ev.unknown(s.test, "a loop ends here")
    body, node = s.body, test.node if isinstance(test, Data) else tree.const(True)
    if test is None:
        jump = tree.at(tree.Break(), s)
        body = [tree.at(tree.If(tree.UnaryOp(tree.Not(), s.test), [jump], []), s.test), *s.body]
    loop.is_endless = isinstance(node, tree.Constant)
    loop.make = lambda body: tree.While(node, body, [])
    ev.statements(body, f)
    return loop.make


def _test_alone(ev: Evaluator, s: Any, f: Frame) -> bool | Data | None:
    """The test of a loop, None where it takes statements, or is another one for each of several things."""
    before = ev.snapshot()
    block, guarded, pending, depth = ev.block, ev.guarded, list(ev.pending), ev.depth
    try:
        test = ev.test_of(s.test, f)
        if isinstance(test, bool) or not ev.has_acted(before):
            return test
    except Undecided:
        ev.block, ev.guarded, ev.pending[:], ev.depth = block, guarded, pending, depth
    ev.restore(before)
    return None


def test_known(ev: Evaluator, s: Any, f: Frame) -> bool | None:
    """The test of a loop before its first round, None where it is not known; what the test does is done where there is
    no round."""
    before = ev.snapshot()
    test = ev.test_of(s.test, f)
    if test is not False:
        ev.restore(before)
    return None if isinstance(test, Data) else test
