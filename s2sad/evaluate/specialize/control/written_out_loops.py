"""Loops that are written out, round by round.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import NOWHERE, Leave
from s2sad.evaluate.specialize.values import LARGEST_SEQUENCE, NONE, Data, Value


_MOST_EXITS = 64        # of a `while`, at each of which the run may leave it
_SEVERAL = 4            # times that each round is evaluated, once for each of the ways that go on to it: a `break`
                        # within two branches doubles them each round


# -- loops that are written out --------------------------------------------------------------------------------------
@operation
def unrolled(ev: Evaluator, s: Any, cursor: Any, f: Frame, bind: Callable[[Value], None]) -> None:
    """The rounds of a loop one after the other; `cursor` gives the items as a loop comes to them."""
    ev.pending.append(None)
    after = len(ev.pending) - 1         # `break` goes here
    depth = len(ev.loops)
    ev.loops.append((after, NOWHERE))

    evaluated = 0

    def rounds(cursor: Any, count: int) -> None:
        nonlocal evaluated
        while True:
            ev.unrolled_loops[s] = max(count, ev.unrolled_loops.get(s, 0))
            found = cursor.next()
            if found is None:
                del ev.loops[depth:]        # a jump in `else` is one of the loop around
                ev.statements(s.orelse, f)
                return
            item, cursor = found
            count += 1
            evaluated += 1
            is_long = count > ev.unroll_limit
            if ev.may_stay and (is_long or evaluated > _SEVERAL * (count + _SEVERAL)):
                ev.stayed |= is_long        # without a limit it would be written out
                raise ev.unknown(s, "a loop of many rounds would be written out")
            if count > LARGEST_SEQUENCE:
                raise ev.refusal(s, f"a loop of more than {LARGEST_SEQUENCE} rounds, of which something must be known "
                                 "before the run", help="let it run over arrays")
            ev.loops[-1] = (after, NOWHERE)
            ev.later(lambda cursor=cursor, count=count: rounds(cursor, count))
            ev.pending.append(None)
            mark = len(ev.pending) - 1
            ev.loops[-1] = (after, mark)
            bind(item)
            try:
                ev.statements(s.body, f)
            except Leave as leave:
                if leave.mark != mark:
                    raise
            finally:
                del ev.pending[mark - 1:]
    try:
        rounds(cursor, 0)
    except Leave as leave:
        if leave.mark != after:
            raise
    finally:
        del ev.loops[depth:]
        del ev.pending[after:]


class WhileCursor:
    """The rounds of a `while` whose test is known."""

    def __init__(self, ev: Evaluator, s: Any, f: Frame):
        self.ev, self.s, self.f, self.depth = ev, s, f, len(ev.guarded)

    def next(self) -> tuple[Value, WhileCursor] | None:
        if len(self.ev.guarded) - self.depth > _MOST_EXITS:
            raise self.ev.unknown(self.s, "only the run knows when this loop ends, of which something must be known "
                                  "before it", help="let it run over arrays and numbers")
        test = self.ev.test_of(self.s.test, self.f)
        if isinstance(test, Data):
            raise self.ev.unknown(self.s.test, "the test of a loop that must be written out is not known", test)
        return (NONE, self) if test else None
