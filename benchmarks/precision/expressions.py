"""Errors of gradients of the expressions of `fpbench`, in ulp of the value scaled by the condition.

With x moved by a unit in its last place a derivative moves by its condition, the sum of |x_i d2f/dx_i dx_j|, which no
computation with rounded numbers can be better than. Where terms cancel the expression itself loses digits beside,
whoever differentiates it: the value's error stands beside the gradient's.
"""
from __future__ import annotations

import inspect
import statistics
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import s2sad
from benchmarks.precision import reference
from benchmarks.precision.fpbench import LISTED, Expression
from benchmarks.precision.quad import as_quad
from benchmarks.precision.rules import loaded
from benchmarks.tables import Table

MOVED = 2.0 ** -20
LARGEST, SMALLEST = 1e4, 1e-4


@dataclass(frozen=True)
class Errors:
    """Of one expression: the medians over its points, in ulp, of the gradient and of the value, and the largest."""
    name: str
    gradient: float
    largest: float
    value: float
    unscaled: float
    honest: float       # how far the references' adjoint and tangent part


def points(expression: Expression, count: int) -> list[np.ndarray]:
    """Arguments drawn in the domain, an array for each."""
    random = np.random.default_rng(31)
    kept: list[list[float]] = []
    while len(kept) < count:
        drawn = [_drawn(random, low, high) for low, high in expression.ranges]
        if expression.holds(*drawn) and _finite(expression, drawn):
            kept.append(drawn)
    return [np.array(column) for column in zip(*kept)]


def _drawn(random: np.random.Generator, low: float | None, high: float | None) -> float:
    if low is not None and high is not None:
        return random.uniform(low, high)
    size = 10.0 ** random.uniform(np.log10(SMALLEST), np.log10(LARGEST))
    return size if low is not None else random.choice((-1.0, 1.0)) * size


def _finite(expression: Expression, drawn: Sequence[float]) -> bool:
    try:
        return bool(np.isfinite(expression.function(*drawn)))
    except (ValueError, ZeroDivisionError, OverflowError):
        return False


def kernel(expression: Expression, folder: Path) -> Any:
    """A kernel that computes the expression at each point."""
    name, names = expression.function.__name__, list(inspect.signature(expression.function).parameters)
    source = inspect.getsource(expression.function)
    text = source[source.index("def "):] + (
        f"\n\ndef kernel(out, {', '.join(f'{n}_' for n in names)}):\n    for place in range(out.size):\n"
        f"        out[place] = {name}({', '.join(f'{n}_[place]' for n in names)})\n")
    return loaded(text, folder)


def measured(expression: Expression, folder: Path, count: int) -> Errors:
    """The errors of one expression."""
    function, arguments = kernel(expression, folder), points(expression, count)
    wrt, out, ones = tuple(inspect.signature(function).parameters)[1:], np.zeros(count), np.ones(count)
    derivative = reference.Adjoint(function, (out, *arguments), wrt, ("out",))
    exact = derivative((out, *arguments), {"out": ones})
    found = s2sad.vjp(s2sad.differentiate(function, engine="numpy"), (out, *arguments), {"out": ones}, wrt=wrt)
    scale = {n: np.abs(exact[n]) for n in wrt}
    for k, _ in enumerate(wrt):
        moved = [a * (1.0 + MOVED) if j == k else a for j, a in enumerate(arguments)]
        step = (as_quad(moved[k]) - arguments[k]) / arguments[k]
        other = derivative((out, *moved), {"out": ones})
        for n in wrt:
            scale[n] = scale[n] + np.abs((other[n] - exact[n]) / step)
    errors = np.concatenate([_ulp(found[n], exact[n], scale[n]) for n in wrt])
    plain = np.concatenate([_ulp(found[n], exact[n], np.abs(exact[n])) for n in wrt])
    function(out, *arguments)
    value = reference.value(function, (np.zeros(count), *arguments))[1]["out"]
    return Errors(expression.function.__name__, float(np.median(errors)), float(np.max(errors)),
                  float(np.median(_ulp(out, value, np.abs(value)))), float(np.median(plain)),
                  reference.mismatch(function, (np.zeros(2), *(a[:2] for a in arguments)), wrt, ("out",))[0])


def _ulp(found: Any, exact: Any, scale: Any) -> np.ndarray:
    unit = np.spacing(np.maximum(scale.astype(float), 2.0 ** -1022))
    return np.where(scale == 0, 0.0, (np.abs(as_quad(found) - exact) / unit).astype(float))


def table(count: int = 40) -> tuple[Table, list[Errors]]:
    """The median over all expressions, and the ten with the largest errors."""
    with tempfile.TemporaryDirectory() as folder:
        found = [measured(expression, Path(folder), count) for expression in LISTED]
    worst = sorted(found, key=lambda e: -e.gradient)[:10]
    made = Table("FPBench: the ten largest errors of the gradient, in ulp",
                 ("expression", "gradient, median", "largest", "without the condition", "value, median"))
    made.rows = [(f"`{e.name}`", *(f"{v:.2g}" for v in (e.gradient, e.largest, e.unscaled, e.value))) for e in worst]
    made.notes = [
        f"Of {len(found)} expressions at {count} points each the median of the gradients' errors is "
        f"{statistics.median(e.gradient for e in found):.2f} ulp of the value scaled by its condition, and "
        f"{statistics.median(e.unscaled for e in found):.2f} ulp of the value itself.",
        f"{sum(e.gradient <= 2.0 for e in found)} expressions are below 2 ulp. Adjoint and tangent of the references "
        f"part by {max(e.honest for e in found):.0e} at most.",
        "Where these lose digits nearly equal terms cancel: in the expression itself, or, as in t / (t + 1), where the "
        "derivatives of its parts meet."]
    return made, found
