"""Functions that call themselves, as often as what is known before the run says."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case, outputs


def power(x, n):
    if n == 0:
        return 1.0
    return x * power(x, n - 1)


def fibonacci(x, n):
    return x if n < 2 else fibonacci(x, n - 1) * x + fibonacci(x, n - 2)


def smoothed(u, level):
    if level > 0:
        u[1:-1] = 0.5 * (u[:-2] + u[2:])
        coarse = u[::2].copy()
        smoothed(coarse, level - 1)
        u[::2] += 0.1 * coarse
    u *= 1.1


def cycle(x, levels):
    u = x.copy()
    smoothed(u, levels)
    return np.sum(u ** 2)


def halved(x, parts):
    if len(parts) == 1:
        return parts[0] * x[0]
    middle = len(parts) // 2
    return halved(x, parts[:middle]) + x[1] * halved(x, parts[middle:])


def in_halves(x):
    return halved(x, [1.0, x[1], 3.0, x[2], 5.0])


def until(x, limit):
    if x > limit:
        return x
    return x * until(x * x, limit)


def cases():
    x = np.linspace(0.5, 1.5, 9)
    for kernel, arguments in ((power, (1.3, 3)), (power, (1.3, 5)), (fibonacci, (0.7, 6)), (cycle, (x, 2)),
                              (in_halves, (x,))):
        yield Case(kernel, arguments, "x", outputs(kernel, arguments))
    yield Case(until, (1.3, 5.0), "x", refused=(
        "S204 at `until(x * x, limit)`: 'until' calls itself more than 60 deep: recursion must end for what is known "
        "before the run"))
