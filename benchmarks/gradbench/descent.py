"""The gradient descent of the evals `particle` and `saddle`."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

Point = np.ndarray


def lowest(value: Callable[[Point], float], gradient: Callable[[Point], Point], start: Point) -> Point:
    """Where the value is smallest: the rate halves where the value would grow, and doubles after ten steps.

    >>> lowest(lambda x: float(x @ x), lambda x: 2.0 * x, np.array([1.0])).round(3)
    array([0.])
    """
    x, rate, steps, found, slope = start, 1e-5, 0, value(start), gradient(start)
    while np.linalg.norm(slope) > 1e-5:
        if steps == 10:
            rate, steps = 2.0 * rate, 0
            continue
        new = x - rate * slope
        if np.linalg.norm(new - x) <= 1e-5:
            break
        next_found = value(new)
        if next_found < found:
            x, found, slope, steps = new, next_found, gradient(new), steps + 1
        else:
            rate, steps = 0.5 * rate, 0
    return x
