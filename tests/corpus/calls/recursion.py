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


def twice(n, x):
    if n <= 1:
        return x
    for _ in range(2):
        x = twice(n // 2, x) * x
    return x


def as_deep_as_a_size_says(x):
    return twice(x.size, x[0])


def halves(x, first, last):
    if last - first == 1:
        return x[first] ** 2
    middle, s = (last - first) // 2, 0.0
    for k in range(2):
        s = s * x[0] + halves(x, first + k * middle, first + (k + 1) * middle)
    return s


def as_deep_as_counters_say(x):
    s = 0.0
    for t in range(3):
        s += halves(x, 0, 4) * (t + 1)
    return s


def orders(x, k, s):
    if k == 3:
        return s + x[0] * x[1] ** 2 * x[2] ** 3
    for i in range(k, 3):
        x[k], x[i] = x[i], x[k]
        s = orders(x, k + 1, s)
        x[k], x[i] = x[i], x[k]
    return s


def in_all_orders(x):
    return orders(x.copy(), 0, 0.0)


def without_end(x, n):
    for _ in range(2):
        x = without_end(x, n + 1) * x
    return x


def place(i, j, m):
    return i * m + j


def where_a_function_says(x):
    pinned, found = {place(0, 0, 3), place(0, 2, 3)}, {}
    found[place(1, 0, 3)] = x[4] ** 2
    s = found[3]
    for k in range(len(x)):
        if k not in pinned:
            s += x[k] * x[0]
    return s


def forces(x):
    a = np.zeros_like(x)
    for i in range(x.shape[0]):
        a[i] = np.sum(np.sin(x - x[i]) / (1.0 + (x - x[i]) ** 2))
    return a


def leap(x):
    x = x + 0.1 * forces(x)
    return x, forces(x)


def of_a_parameter_bound_anew(x):
    x, v = leap(x)
    x, v = leap(x)
    return np.sum(x * v ** 2)


def cases():
    x = np.linspace(0.5, 1.5, 9)
    for kernel, arguments in ((power, (1.3, 3)), (power, (1.3, 5)), (fibonacci, (0.7, 6)), (cycle, (x, 2)),
                              (in_halves, (x,)), (as_deep_as_a_size_says, (x,)), (as_deep_as_counters_say, (x,)),
                              (in_all_orders, (x,)), (where_a_function_says, (x,)),
                              (of_a_parameter_bound_anew, (x,))):
        yield Case(kernel, arguments, "x", outputs(kernel, arguments))
    yield Case(until, (1.3, 5.0), "x", refused=(
        "S204 at `until(x * x, limit)`: 'until' calls itself more than 60 deep: recursion must end for what is known "
        "before the run"))
    yield Case(without_end, (1.3, 0), "x", refused=(
        "S204 at `without_end(x, n + 1)`: 'without_end' calls itself more than 60 deep: recursion must end for what is "
        "known before the run"))
