"""Choices between numbers whose operands are lost: which way they went is recorded, wherever a choice can stand."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def relaxed(path):
    # both competitors are overwritten, in the next round at the latest
    for k in range(path.shape[0]):
        for i in range(path.shape[0]):
            for j in range(path.shape[1]):
                path[i, j] = min(path[i, j], path[i, k] + path[k, j])


def relaxed_by_arrays(path):
    for k in range(path.shape[0]):
        path[:] = np.minimum(path[:], np.add.outer(path[:, k], path[k, :]))


def operand_overwritten_at_once(x, y):
    # the statement itself overwrites what it compares, the next one the other side
    for i in range(x.size):
        x[i] = max(x[i], y[i])
        y[i] = x[i] * y[i]
        y[i] = min(y[i], x[i] - 0.25) * x[i]


def picked_elements(x, y, i, j):
    # two names of one element, by index arrays that repeat
    for k in range(i.size):
        x[i[k]] = max(x[i[k]], x[j[k]] * y[k]) + 0.5 * min(x[j[k]], y[k])


def moving_bounds(x, low, high):
    # clip's bounds change in the loop, and are active; backwards, by a step of -2
    for i in range(x.size - 1, -1, -2):
        x[i] = np.clip(x[i], low, high) * x[i]
        low = low * 0.9 - 0.01 * x[i]
        high = max(high * 0.8, low + 0.2)
    return low * high


def nested_choices(x, y):
    # a choice among choices, and one condition that several partials ask
    total = 0.0
    for i in range(1, x.size):
        x[i] = max(min(x[i], y[i]), 0.9 * max(x[i - 1], 0.3)) * np.where(x[i] > y[i], x[i], y[i])
        total += np.where((x[i] > 1.0) | (y[i] > x[i]), x[i] * y[i], max(total, x[i]))
    return total


def in_a_branch(x, y):
    # in one arm alone, in a loop that stops early, beside integers that are chosen
    best, k = x[0], 0
    while k < x.size and best < 40.0:
        if y[k] > 0.0:
            best = max(best, x[k] * y[k])
            x[max(k - 1, 0)] = best * x[k]
        else:
            best = best + min(x[k], 0.4) * best
        y[k] = y[k] * best
        k = max(k + 1, 1)
    return best


def never_run(x, n):
    m = x[0]
    for i in range(1, n):
        m = max(m, x[i])
        x[i] = m * x[i]
    return m


def single_precision(x, y):
    for _ in range(3):
        for i in range(x.size):
            x[i] = max(x[i] * y[i], y[i]) + np.float32(0.25) * abs(x[i])
            y[i] = min(x[i], y[i] + np.float32(1.5))


def cases():
    rng = generator(31)
    arrays = (("x", "y"), ("x", "y"))
    for kernel in (relaxed, relaxed_by_arrays):
        yield Case(kernel, (rng.uniform(0.1, 3.0, (5, 5)),), ("path",), ("path",))
    yield Case(operand_overwritten_at_once, (rng.uniform(0.5, 2.0, 6), rng.uniform(0.5, 2.0, 6)), *arrays)
    yield Case(picked_elements, (rng.uniform(0.5, 2.0, 4), rng.uniform(0.5, 2.0, 7), rng.integers(0, 4, 7),
                                 rng.integers(0, 4, 7)), ("x", "y"), ("x",))
    yield Case(moving_bounds, (rng.uniform(-1.0, 1.0, 7), -0.41, 0.53), ("x", "low", "high"), ("x", "return"))
    yield Case(nested_choices, (rng.uniform(0.2, 2.0, 6), rng.uniform(0.2, 2.0, 6)), ("x", "y"), ("x", "return"))
    yield Case(in_a_branch, (rng.uniform(0.5, 1.5, 6), rng.uniform(-1.0, 2.0, 6)), ("x", "y"), ("x", "y", "return"))
    for n in (0, 1, 5):
        yield Case(never_run, (rng.uniform(0.5, 1.5, 5), n), ("x",), ("x", "return"))
    yield Case(single_precision, (rng.uniform(0.3, 1.2, 5).astype(np.float32), rng.uniform(
        0.3, 1.2, 5).astype(np.float32)), *arrays, options={"rtol": 2e-2})
