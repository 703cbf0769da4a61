"""How exact the gradients are: against differences in extended precision."""
from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence
from types import FunctionType, SimpleNamespace
from typing import Any

import numpy as np

from benchmarks.calls import adjoint_arguments, differentiated, fresh, seed_like
from benchmarks.kernels.cases import CASES, Case
from benchmarks.tables import Table, verdict

TARGET = 1e-7
STEPS = (1e-3, 5e-4, 2.5e-4, 1.25e-4)
EXTENDED = np.longdouble


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """Each kernel at its small size."""
    table = Table("Error of the gradient, small size", ("kernel", "inputs", "largest error", "target", ""))
    for name in CASES:
        inputs, error = measured(CASES[name])
        table.rows.append((name, str(inputs), f"{error:.1e}", f"{TARGET:g}", verdict(error, TARGET)))
    digits = np.finfo(EXTENDED).precision
    table.notes = [f"against differences of the kernel run in Python with {digits} digits, extrapolated four times;",
                   "the error is relative to the largest element of that argument's gradient"]
    return [table]


def measured(case: Case) -> tuple[int, float]:
    """How many inputs there are, and the worst error of their derivatives."""
    names = list(inspect.signature(case.function).parameters)
    arguments = case.arguments("small")
    shadowed = adjoint_arguments(case, arguments)
    returned = differentiated(case).adjoint(*shadowed)
    floats = [n for n, a in zip(names, arguments) if isinstance(a, float) and n in case.wrt]
    gradients = dict(zip(floats, returned or ()))
    rest = iter(shadowed)
    for name, value in zip(names, arguments):
        next(rest)
        if isinstance(value, np.ndarray) and name in {*case.wrt, *case.of}:
            gradients[name] = next(rest)
    errors, inputs = [], 0
    for name in case.wrt:
        expected = differences(case, names, arguments, name)
        inputs += expected.size
        scale = float(np.max(np.abs(expected))) or 1.0
        errors.append(float(np.max(np.abs(expected - gradients[name]))) / scale)
    return inputs, max(errors)


def differences(case: Case, names: Sequence[str], arguments: Sequence[Any], name: str) -> np.ndarray:
    """The derivatives of the seeded outputs by each element of one argument."""
    function, place = extended(case.function), names.index(name)
    base = [a.astype(EXTENDED) if isinstance(a, np.ndarray) and a.dtype.kind == "f" else a for a in arguments]
    base = [EXTENDED(a) if isinstance(a, float) else a for a in base]

    def moved(index: int, step: Any) -> Any:
        given = fresh(base)
        if isinstance(given[place], np.ndarray):
            given[place].flat[index] += step
        else:
            given[place] = given[place] + step
        result = function(*given)
        total = result if "return" in case.of else EXTENDED(0)
        return total + sum(np.sum(given[names.index(o)] * seed_like(given[names.index(o)]))
                           for o in case.of if o != "return")

    return np.array([_extrapolated(lambda step, k=k: moved(k, step)) for k in range(np.size(arguments[place]))],
                    EXTENDED).reshape(np.shape(arguments[place]))


def extended(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function and its helpers in Python with `math` and work arrays of extended precision."""
    assert isinstance(function, FunctionType)
    space = dict(function.__globals__)
    for name, value in function.__globals__.items():
        if isinstance(value, FunctionType) and value.__module__ == function.__module__:
            space[name] = FunctionType(value.__code__, space, value.__name__, value.__defaults__, value.__closure__)
    space["np"] = SimpleNamespace(empty=lambda shape: np.empty(shape, EXTENDED), empty_like=np.empty_like, sum=np.sum)
    space["math"] = SimpleNamespace(exp=np.exp, log=np.log, sqrt=np.sqrt, pi=math.pi)
    return space[function.__name__]


def _extrapolated(value: Callable[[Any], Any]) -> Any:
    """Central differences with halved steps, their errors' powers of the step eliminated (Richardson)."""
    rows = [(value(EXTENDED(h)) - value(EXTENDED(-h))) / (2 * EXTENDED(h)) for h in STEPS]
    for order in range(1, len(rows)):
        rows = [(4 ** order * b - a) / (4 ** order - 1) for a, b in zip(rows, rows[1:])]
    return rows[0]
