"""Calls of a case's primal and adjoint on fresh copies of its arguments."""
from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import cache
from types import FunctionType
from typing import Any

import numba
import numpy as np

import s2sad
from benchmarks.kernels.cases import Case


@cache
def plain_numba(function: Callable[..., Any]) -> Any:
    """A function as its user would compile it: `njit` of it and of the functions of its module, nothing else."""
    assert isinstance(function, FunctionType)
    space = dict(function.__globals__)
    for name, value in function.__globals__.items():
        if isinstance(value, FunctionType) and value.__module__ == function.__module__:
            copied = FunctionType(value.__code__, space, value.__name__, value.__defaults__, value.__closure__)
            space[name] = numba.njit(error_model="numpy")(copied)
    return space[function.__name__]


def differentiated(case: Case, engine: str = "auto") -> Any:
    """The case's function with its derivatives."""
    return s2sad.differentiate(case.function, wrt=case.wrt, of=case.of, engine=engine)


def fresh(arguments: Sequence[Any]) -> list[Any]:
    """The arguments with arrays copied."""
    return [a.copy() if isinstance(a, np.ndarray) else a for a in arguments]


def adjoint_arguments(case: Case, arguments: Sequence[Any]) -> list[Any]:
    """Fresh arguments of `f.adjoint`: outputs' shadows hold random seeds, others zeros; a float result's seed is 1."""
    names = list(inspect.signature(case.function).parameters)
    made: list[Any] = []
    for name, value in zip(names, fresh(arguments)):
        made.append(value)
        if isinstance(value, np.ndarray) and name in {*case.wrt, *case.of}:
            made.append(seed_like(value) if name in case.of else np.full_like(value, 0.0))  # pages in place
    return made + [1.0] * ("return" in case.of)


def seed_like(value: np.ndarray) -> np.ndarray:
    """A seed between 0.5 and 1.5 for each element, always the same; a uniform one would cancel in conserved sums."""
    return (0.5 + np.random.default_rng(11).random(value.shape)).astype(value.dtype)
