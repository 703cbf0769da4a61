"""The classical method of Runge and Kutta with fixed steps, as the text of a kernel over a right-hand side and a loss.

    def loss_of_steps(rate_of, loss_of, u, times, steps, p):
        ...
        return loss_of(us)          of the states at all times
"""
from __future__ import annotations

from functools import partial
from typing import Any

from s2sad.interface.differentiate import Differentiated
from s2sad.interface.value_calls import selection_of
from s2sad.live_objects.unwrap import python_function
from s2sad.naming import Names
from s2sad.odes.right_hand_side import Ode
from s2sad.run.module_loader import load

_NAMES = ("np", "rate_of", "loss_of", "start", "times", "steps", "states", "u", "k", "first", "h", "t", "s1", "s2",
          "s3", "s4", "at", "now")
_TEXT = """import numpy as {np}


def {entry}({rate_of}, {loss_of}, {start}, {times}, {steps}{others}):
    {states} = {np}.zeros(({times}.size, {shape}))
    {u} = {start}.copy()
    {states}[0] = {u}
    for {k} in range(({times}.size - 1) * {steps}):
        {first} = {times}[{k} // {steps}]
        {h} = ({times}[{k} // {steps} + 1] - {first}) / {steps}
        {t} = {first} + ({k} % {steps}) * {h}
{stages}
        {u}[...] = {u} + {h} / 6.0 * ({s1} + 2.0 * {s2} + 2.0 * {s3} + {s4})
        if ({k} + 1) % {steps} == 0:
            {states}[({k} + 1) // {steps}] = {u}
    return {loss_of}({states})
"""


def fixed_steps(rhs: Ode, loss: Any, rank: int) -> tuple[Any, str, str]:
    """The kernel, which takes the state at the first time, the times, the steps between them and all other arguments
    of the right-hand side; the counter of its loop, and the name of the first state."""
    names = Names(rhs.parameters)
    n = {hint: names.fresh(hint) for hint in _NAMES}
    n["entry"] = names.fresh("loss_of_steps")
    stages = ["{at} = {u}.copy()", "{now} = {t}", *_stage(rhs, "s1", n)]
    for stage, part, before in (("s2", "0.5", "s1"), ("s3", "0.5", "s2"), ("s4", "1.0", "s3")):
        stages += [f"{{at}} = {{u}} + {part} * {{h}} * {{{before}}}", f"{{now}} = {{t}} + {part} * {{h}}",
                   *_stage(rhs, stage, n)]
    text = _TEXT.format(**n, shape=", ".join(f"{n['start']}.shape[{k}]" for k in range(rank)),
                        others="".join(f", {o}" for o in rhs.others),
                        stages="\n".join("        " + line.format(**n) for line in stages))
    carried = selection_of(rhs.__wrapped__)
    applied = partial(getattr(load(text, n["entry"]), n["entry"]), python_function(rhs.__wrapped__), loss)
    return Differentiated(applied, None, None, carried.engine), n["k"], n["start"]


def _stage(rhs: Ode, stage: str, n: dict[str, str]) -> list[str]:
    """The rate at one point, written or returned."""
    held = {rhs.rate: n[stage], rhs.state: n["at"], rhs.time: n["now"]}
    call = f"{n['rate_of']}({', '.join(held.get(p, p) for p in rhs.parameters)})"
    if rhs.rate is None:
        return [f"{n[stage]} = {n['np']}.array({call})"]
    return [f"{n[stage]} = {n['np']}.zeros_like({n['u']})", call]
