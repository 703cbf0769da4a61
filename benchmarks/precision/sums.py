"""Sums that derivatives make: of what a number gains in a loop, of what broadcasting is undone by, of products."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

import s2sad
from benchmarks.tables import Table

SIZES = (10 ** 3, 10 ** 5, 10 ** 6)


def gains_of_a_number(u, c):
    """A number that every iteration reads: its adjoint is a sum over the loop."""
    total = 0.0
    for i in range(u.size):
        total += c * u[i]
    return total


def broadcast_number(u, c):
    """A number that broadcasts: its adjoint is the sum of an array."""
    return np.sum(c * u)


def broadcast_row(u, c):
    """A row that broadcasts, read at its first element alone: a sum along an axis."""
    rows = u.reshape(-1, 10)
    row = np.full(10, c)
    return np.sum(rows * row)


def mean_of_squares(u, c):
    """A mean, whose adjoint is spread, and summed again."""
    return np.mean((c * u) ** 2)


def product(u, c):
    """An inner product."""
    return np.dot(u, c * u)


def _exact(kernel: Any, u: np.ndarray, c: float) -> float:
    values = u.astype(float)
    if kernel is mean_of_squares:
        return 2.0 * float(c) * math.fsum(_squares(values)) / u.size
    return math.fsum(_squares(values)) if kernel is product else math.fsum(values)


def _squares(values: np.ndarray) -> list[float]:
    """The squares, exactly, as pairs of numbers."""
    high = values.astype(np.float32).astype(float)
    low = values - high
    return [*(high * high), *(2.0 * high * low), *(low * low)]


def table(quick: bool) -> Table:
    """The errors of the gradient with respect to the number, in ulp of the arrays' dtype."""
    made = Table("Sums in derivatives: errors in ulp of the dtype",
                 ("kernel", "dtype", *(f"{n} terms, {e}" for n in SIZES for e in ("NumPy", "Numba"))))
    for kernel in (gains_of_a_number, broadcast_number, broadcast_row, mean_of_squares, product):
        for dtype in (np.float64, np.float32):
            row = []
            for size in SIZES:
                u = (0.1 + np.random.default_rng(3).random(size)).astype(dtype)
                for engine in ("numpy", "numba"):
                    row.append("-" if quick and engine == "numba" else f"{_error(kernel, u, engine):.1f}")
            made.rows.append((f"`{kernel.__name__}`", np.dtype(dtype).name, *row))
    made.notes = ["All terms are above 0: the condition of the sums is 1."]
    return made


def _error(kernel: Any, u: np.ndarray, engine: str) -> float:
    c = u.dtype.type(1.5)
    found = s2sad.gradient(s2sad.differentiate(kernel, engine=engine), "c")(u, c)
    exact = _exact(kernel, u, c)
    return abs(float(found) - exact) / float(np.spacing(u.dtype.type(exact)))
