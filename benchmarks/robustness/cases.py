"""A hard case: a kernel as its user writes it, and the gradient by its first argument, worked out by hand."""
from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import s2sad

EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Case:
    """What is differentiated where, what comes out, why so (`rule`), who had it wrong (`source`), and the error that is
    allowed, in units of the machine's rounding; `kink` is what `explain` says of the place."""
    what: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    expected: Any
    rule: str = ""
    source: str = ""
    kink: str = ""
    limit: float = 4.0


def gradients(case: Case, engine: str = "numpy") -> tuple[np.ndarray, np.ndarray]:
    """The gradient by the first argument, by the adjoint and by tangents along each of its elements."""
    function = s2sad.differentiate(case.function, engine=engine)
    first = next(iter(inspect.signature(case.function).parameters))
    adjoint = s2sad.gradient(function, wrt=first)(*case.arguments)
    given = np.asarray(case.arguments[0], dtype=float)
    tangents = np.empty(given.shape)
    for place in np.ndindex(given.shape):
        direction = np.zeros(given.shape)
        direction[place] = 1.0
        along = direction if given.shape else 1.0
        tangents[place] = s2sad.jvp(function, case.arguments, {first: along})["return"]
    return np.asarray(adjoint), tangents


def apart(found: np.ndarray, expected: Any) -> float:
    """The largest relative error in units of rounding; absolute where 0 is expected, infinite where nan is not."""
    errors = [_apart(float(f), e) for f, e in zip(np.ravel(found), np.ravel(np.asarray(expected, dtype=object)))]
    return max(errors, default=0.0)


def _apart(found: float, expected: Any) -> float:
    if math.isnan(float(expected)) or math.isinf(float(expected)):
        return 0.0 if found == float(expected) or math.isnan(found) and math.isnan(float(expected)) else math.inf
    if not math.isfinite(found):
        return math.inf
    return float(abs(found - expected) / (abs(expected) * EPS if expected else 1.0))


def explained(case: Case) -> str:
    """What `explain` lists of places that are not differentiable."""
    return str(s2sad.explain(case.function, *case.arguments)).partition("not differentiable")[2]
