"""Differences of the compiled kernel, one input after the other, and the complex step where the kernel allows it."""
from __future__ import annotations

import warnings
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.calls import fresh, plain_numba
from benchmarks.peers.ours import compiled
from benchmarks.peers.problems import Problem, Run, Unsupported

STEPS = {"forward differences": (1e-3, 1e-5, 1e-7, 1e-8, 1e-10, 1e-12),
         "central differences": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10)}
USUAL = {"forward differences": 1e-8, "central differences": 1e-5, "complex step": 1e-30}
LONGEST = 2.0    # seconds for one gradient


def prepare(variant: str, kernel: str, problem: Problem, step: float | None = None) -> Run:
    """The gradient by one more call of the kernel for each input, or two; steps are relative to the input."""
    width = USUAL[variant] if step is None else step
    arguments = problem.arguments
    if variant == "complex step":
        arguments = tuple(a.astype(complex) if isinstance(a, np.ndarray) and a.dtype.kind == "f" else a
                          for a in arguments)
        function = _complex(problem, arguments)
    else:
        function = compiled(problem)
    total = seeded(function, problem)
    total(fresh(arguments))
    start = perf_counter()
    total(fresh(arguments))
    expected = (perf_counter() - start) * problem.inputs * (2 if variant.startswith("central") else 1)
    if expected > LONGEST:
        raise Unsupported(f"{problem.inputs} inputs would take {expected:.0f} s")
    places = [problem.names.index(name) for name in problem.case.wrt]
    return Run(lambda: [_partials(variant, total, arguments, place, width) for place in places], list)


def seeded(function: Callable[..., Any], problem: Problem) -> Callable[[list[Any]], Any]:
    """The seeded sum of the outputs, of arguments that may be written."""
    pairs = [(problem.names.index(name) if name != "return" else -1, seed)
             for name, seed in zip(problem.case.of, problem.seeds)]

    def total(arguments: list[Any]) -> Any:
        returned = function(*arguments)
        return sum(returned if place < 0 else np.sum(arguments[place] * seed) for place, seed in pairs)

    return total


def _partials(variant: str, total: Callable[[list[Any]], Any], arguments: tuple[Any, ...], place: int, width: float
              ) -> Any:
    value = arguments[place]
    base = total(fresh(arguments)) if variant.startswith("forward") else 0.0
    found = np.empty(np.size(value))
    for k in range(found.size):
        h = width * (abs(value.flat[k] if isinstance(value, np.ndarray) else value) or 1.0)
        if variant == "complex step":
            found[k] = total(_moved(arguments, place, k, 1j * h)).imag / h
        elif base:
            found[k] = (total(_moved(arguments, place, k, h)) - base) / h
        else:
            found[k] = (total(_moved(arguments, place, k, h)) - total(_moved(arguments, place, k, -h))) / (2.0 * h)
    return found.reshape(np.shape(value))


def _moved(arguments: tuple[Any, ...], place: int, k: int, change: Any) -> list[Any]:
    given = fresh(arguments)
    if isinstance(given[place], np.ndarray):
        given[place].flat[k] += change
    else:
        given[place] = given[place] + change
    return given


def _complex(problem: Problem, arguments: tuple[Any, ...]) -> Callable[..., Any]:
    """The kernel for complex arrays: compiled, or as NumPy runs it where Numba has no types for it."""
    from numba.core.errors import NumbaError
    plain = plain_numba(problem.case.function)
    floats = [k for k, name in enumerate(problem.names) if name in problem.case.wrt and isinstance(arguments[k], float)]
    given = [complex(a) if k in floats else a for k, a in enumerate(fresh(arguments))]
    try:
        plain(*given)
        return plain
    except NumbaError:
        function = problem.case.function
    warnings.simplefilter("error", np.exceptions.ComplexWarning)
    try:
        function(*given)
    except (TypeError, np.exceptions.ComplexWarning) as problem_with:
        raise Unsupported(f"the kernel takes no complex numbers ({str(problem_with).splitlines()[0]})") from None
    return function
