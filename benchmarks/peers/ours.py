"""s2sad itself: both engines, both levels, and single precision; what a call has overwritten is restored, timed."""
from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import cache
from types import FunctionType
from typing import Any

import numba
import numpy as np

from benchmarks.calls import adjoint_arguments, differentiated, fresh, plain_numba
from benchmarks.kernels.cases import ARRAYS, Case
from benchmarks.peers.problems import Problem, Run
from benchmarks.peers.tools import PRIMALS
from s2sad.dispatch.memory_reuse import MemoryReuse



def prepare(variant: str, kernel: str, problem: Problem) -> Run:
    """The bare adjoint of one engine and level, or the primal."""
    engine = "numba" if "Numba" in variant else "numpy"
    if variant in PRIMALS:
        return _primal(problem, engine)
    arguments = problem.arguments
    if variant.endswith("float32"):
        arguments = tuple(a.astype(np.float32) if isinstance(a, np.ndarray) and a.dtype == np.float64 else a
                          for a in arguments)
    shadowed = adjoint_arguments(problem.case, arguments)
    made = differentiated(problem.case, engine)
    if variant.endswith("plain"):
        text = made.adjoint_source(*fresh(arguments), level="plain")
        adjoint = written(text, problem.case.function.__name__, engine == "numba")
    else:
        adjoint = made.compiled("adjoint", *shadowed)
    return restoring(adjoint, shadowed, problem.case)


@cache
def written(text: str, name: str, compiles: bool) -> Callable[..., Any]:
    """The adjoint of a generated module, as one has it who keeps the file, compiles it or not."""
    space: dict[str, Any] = {"__name__": "written"}
    exec(compile(text, "<written>", "exec"), space)
    adjoint = space[next(n for n in reversed(list(space)) if n.startswith(f"{name}_adjoint"))]
    if not compiles:
        return adjoint
    for called, value in space.items():     # what the module imports of s2sad.runtime
        if isinstance(value, FunctionType) and value.__module__ != "written":
            space[called] = numba.njit(error_model="numpy")(value)
    return plain_numba(adjoint)


def restoring(adjoint: Callable[..., Any], shadowed: Sequence[Any], case: Case) -> Run:
    """Calls on the same arrays again and again: those that a first call changes are filled again before each."""
    working = fresh(shadowed)
    adjoint(*working)
    changed = [(now, before) for now, before in zip(working, shadowed)
               if isinstance(now, np.ndarray) and not np.array_equal(now, before, equal_nan=True)]

    def call() -> Any:
        for now, before in changed:
            np.copyto(now, before)
        return adjoint(*working)

    def gradients(returned: Any) -> list[Any]:
        shadows = shadows_of(case, working)
        numbers = iter(returned if isinstance(returned, tuple) else (returned,))
        found = {n: shadows[n] if n in shadows else next(numbers)
                 for n in inspect.signature(case.function).parameters if n in case.wrt}
        return [found[n] for n in case.wrt]

    tape = adjoint.stack_bytes if isinstance(adjoint, MemoryReuse) else 0
    return Run(call, gradients, tape + sum(now.nbytes for now in shadows_of(case, working).values()))


def shadows_of(case: Case, shadowed: Sequence[Any]) -> dict[str, np.ndarray]:
    """The shadows among the arguments of an adjoint, by their array's name."""
    found: dict[str, np.ndarray] = {}
    position = 0
    for name in inspect.signature(case.function).parameters:
        if isinstance(shadowed[position], np.ndarray) and name in {*case.wrt, *case.of}:
            position += 1
            found[name] = shadowed[position]
        position += 1
    return found


def _primal(problem: Problem, engine: str) -> Run:
    """The kernel itself: as NumPy runs it, or compiled, by `njit` where that takes it and else by s2sad."""
    function = problem.case.function
    if engine == "numba":
        function = compiled(problem)
    working = fresh(problem.arguments)
    function(*working)
    changed = [(now, before) for now, before in zip(working, problem.arguments)
               if isinstance(now, np.ndarray) and not np.array_equal(now, before, equal_nan=True)]

    def call() -> None:
        for now, before in changed:
            np.copyto(now, before)
        function(*working)

    return Run(call, lambda _: [])


def compiled(problem: Problem) -> Callable[..., Any]:
    """The kernel with its loops under plain `njit`; one of whole arrays as s2sad compiles it, which is faster."""
    if problem.case in ARRAYS:
        return differentiated(problem.case, "numba").compiled("primal", *fresh(problem.arguments))
    return plain_numba(problem.case.function)
