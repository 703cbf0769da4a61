"""Methods of Runge and Kutta with fixed steps, as the text of a kernel over a right-hand side and a loss.

    def loss_of_steps(rate_of, loss_of, u, times, steps, p):
        ...
        return loss_of(us)          of the states at all times

A stage whose rate is on both sides of its equation is found by Newton's method, with the Jacobian that the text calls;
it goes one step beyond what is small enough, for its derivative is one step behind. (Hairer and Wanner, Solving
Ordinary Differential Equations II, Springer 1996, IV.6; Griewank and Walther, Evaluating Derivatives, SIAM 2008, 15.)
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from textwrap import indent
from typing import Any

import numpy as np

from s2sad.interface.differentiate import Differentiated
from s2sad.interface.value_calls import selection_of
from s2sad.naming import Names
from s2sad.odes.right_hand_side import Ode
from s2sad.run.module_loader import load


@dataclass(frozen=True)
class Method:
    """The coefficients of a method: for each stage the parts of the rates before it and, where it is implicit, of its
    own; and the weights of all rates in a step. The time of a stage is the sum of its parts."""
    parts: tuple[tuple[float, ...], ...]
    weights: tuple[float, ...]

    @property
    def is_implicit(self) -> bool:
        return len(self.parts[0]) > 0

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        made = np.zeros((len(self.parts), len(self.parts)))
        for row, given in zip(made, self.parts):
            row[:len(given)] = given
        return made, np.array(self.weights)


_G = 1.0 - 0.5 ** 0.5
METHODS = {
    "RK4": Method(((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
    "midpoint": Method(((0.5,),), (1.0,)),
    "SDIRK2": Method(((_G,), (1.0 - _G, _G)), (1.0 - _G, _G)),
    "SDIRK4": Method(((1 / 4,), (1 / 2, 1 / 4), (17 / 50, -1 / 25, 1 / 4), (371 / 1360, -137 / 2720, 15 / 544, 1 / 4),
                      (25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4)), (25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4)),
}
NOT_CONVERGED = "Newton's method did not converge"
_MOST, _SMALL = 20, 1e-8        # steps of Newton's method, and what of a state is small

_NAMES = ("np", "s2sad", "rate_of", "loss_of", "start", "times", "steps", "parts", "weights", "states", "u", "k",
          "first", "h", "t", "i", "j", "rates", "at", "now", "known", "rate", "own", "change", "tries",
          "settled", "jacobian", "given")
_TEXT = """import numpy as {np}
import s2sad as {s2sad}


def {entry}({rate_of}, {loss_of}, {start}, {times}, {steps}, {parts}, {weights}{others}):
    {states} = {np}.zeros(({times}.size, {shape}))
    {rates} = {np}.zeros(({weights}.size, {shape}))
    {u} = {start}.copy()
    {states}[0] = {u}
    for {k} in range(({times}.size - 1) * {steps}):
        {first} = {times}[{k} // {steps}]
        {h} = ({times}[{k} // {steps} + 1] - {first}) / {steps}
        {t} = {first} + ({k} % {steps}) * {h}
        for {i} in range({weights}.size):
            {known} = {u}.copy()
            for {j} in range({i}):
                {known} += {h} * {parts}[{i}, {j}] * {rates}[{j}]
            {now} = {t} + {h} * {np}.sum({parts}[{i}])
{stage}
        for {i} in range({weights}.size):
            {u} += {h} * {weights}[{i}] * {rates}[{i}]
        if ({k} + 1) % {steps} == 0:
            {states}[({k} + 1) // {steps}] = {u}
    return {loss_of}({states})
"""
_EXPLICIT = """{evaluated}
{rates}[{i}] = {rate}"""
_NEWTON = """{own} = {h} * {parts}[{i}, {i}]
{at} = {u}.copy()
{settled} = False
for {tries} in range({most}):
    {given} = {at}.copy()
    {evaluated}
    {jacobian} = {np}.eye({u}.size) - {own} * {s2sad}.jacobian({rate_of}, wrt="{wrt}", of="{of}")({arguments}){flat}
    {change} = {np}.linalg.solve({jacobian}, ({at} - {known} - {own} * {rate}){column}){like}
    {at} = {at} - {change}
    if {settled}:
        break
    {settled} = {np}.max({np}.abs({change})) <= {small} * ({np}.max({np}.abs({at})) + {np}.max({np}.abs({u})))
if not {settled}:
    raise ArithmeticError("{failed}")
{rates}[{i}] = ({at} - {known}) / {own}"""


def fixed_steps(rhs: Ode, loss: Any, rank: int, method: Method) -> tuple[Any, str, str]:
    """The kernel, which takes the state at the first time, the times, the steps between them, the coefficients of the
    method, explicit or implicit, and all other arguments of the right-hand side; the counter of its loop, and the name
    of the first state."""
    names = Names(rhs.parameters)
    n = {hint: names.fresh(hint) for hint in _NAMES}
    n["entry"] = names.fresh("loss_of_steps")
    flat = {"flat": f".reshape({n['u']}.size, {n['u']}.size)", "column": ".reshape(-1)",
            "like": f".reshape({n['u']}.shape)"} if rank > 1 else {"flat": "", "column": "", "like": ""}
    if method.is_implicit:
        stage = _NEWTON.format(**n, **flat, most=_MOST, small=_SMALL, failed=NOT_CONVERGED, wrt=rhs.state,
                               evaluated="\n    ".join(_evaluated(rhs, n["given"], n)), of=rhs.rate or "return",
                               arguments=_arguments(rhs, f"{n['np']}.zeros_like({n['u']})", n["at"], n))
    else:
        stage = _EXPLICIT.format(**n, evaluated="\n".join(_evaluated(rhs, n["known"], n)))
    text = _TEXT.format(**n, shape=", ".join(f"{n['start']}.shape[{k}]" for k in range(rank)),
                        others="".join(f", {o}" for o in rhs.others), stage=indent(stage, 12 * " "))
    carried = selection_of(rhs.__wrapped__)
    applied = partial(getattr(load(text, n["entry"]), n["entry"]), rhs.read, loss)
    return Differentiated(applied, None, None, carried.engine), n["k"], n["start"]


def _evaluated(rhs: Ode, at: str, n: dict[str, str]) -> list[str]:
    """The rate at one point, written or returned."""
    call = f"{n['rate_of']}({_arguments(rhs, n['rate'], at, n)})"
    return [f"{n['rate']} = {call}"] if rhs.rate is None else [
        f"{n['rate']} = {n['np']}.zeros_like({n['u']})", call]


def _arguments(rhs: Ode, rate: str, at: str, n: dict[str, str]) -> str:
    held = {rhs.rate: rate, rhs.state: at, rhs.time: n["now"]}
    return ", ".join(held.get(p, p) for p in rhs.parameters)
