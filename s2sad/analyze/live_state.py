"""live_state: what must be kept of a step of a loop so that the rest of the loop can run again from there.

Requires the step in normal form. A number or an array that the loop changes is state where a later step, or the
adjoint of one, reads what an earlier one left there. An array that each step fills before it reads it (`work_arrays`)
is none.
"""
from __future__ import annotations

from collections.abc import Collection, Mapping

from s2sad.analyze.work_arrays import Callees, refills
from s2sad.liveness import Accesses, Liveness
from s2sad.tree import FunctionDef, Return, with_body


def live_state(step: FunctionDef, counter: str, changed: Mapping[str, str], needed: Collection[str],
               accesses: Accesses, callees: Callees) -> set[str]:
    """Those of a step's parameters that are state; `changed` has the name that each parameter which a step changes goes
    by where the step ends, `needed` are those that its adjoint reads, `counter` is the one that the loop counts."""
    ends = step.body[-1:] if isinstance(step.body[-1], Return) else []
    body = with_body(step, step.body[:len(step.body) - len(ends)])
    parameters = [p.id for p in step.args.args]
    fixed = ({p for p in parameters if p not in changed} - {counter}) | {"=" + p for p in parameters}
    free = {a for a in changed if changed[a] == a and refills(step, a, fixed, callees)}
    state = ({*needed} & {*changed}) - free
    while True:
        start = Liveness(body, {changed[n] for n in state}, accesses).start
        grown = state | ((start & {*changed}) - free)
        if grown == state:
            return state
        state = grown
