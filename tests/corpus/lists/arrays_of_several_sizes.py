"""Written lists of arrays of several sizes, of which the counters of short loops with written bounds pick elements."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def given(count: int) -> np.ndarray:
    return generator(8).uniform(0.3, 1.2, count)


def summed(x):
    levels = [x.copy(), x[::2] * x[1::2]]
    s = 0.0
    for k in range(2):
        s += np.sum(levels[k] ** 2)
    return s


def down_and_up(x):
    levels = [x * 1.0, x[::2] * x[1::2], x[::4] ** 2]
    for k in range(2, 0, -1):
        levels[k - 1] += 0.3 * np.repeat(levels[k], 2)
    s = 0.0
    for k in range(3):
        s += np.sum(levels[k] ** 2) * (k + 1)
    return s * levels[-1][0]


def allocated(x):
    levels = [np.zeros(8), np.zeros(4), np.zeros(2)]
    levels[0][:] = x
    for k in range(2):
        levels[k + 1][:] = 0.5 * (levels[k][::2] + levels[k][1::2]) ** 2
    for k in range(1, -1, -1):
        levels[k][::2] += levels[k + 1]
    return levels[0]


def nested(x):
    levels = [x.copy(), x[::2] * 1.0]
    for k in range(2):
        for j in range(2):
            levels[k][j] *= levels[j][k]
    return np.sum(levels[0]) + np.sum(levels[1])


def bound_anew(x):
    levels = [x.copy(), x[::2] * 1.0]
    for k in range(2):
        levels[k] = levels[k - 1] ** 2 if k > 1 else levels[k] ** 3
    return np.sum(levels[0]) * np.sum(levels[1])


def of_one_size(x):
    buffers = [x.copy(), x[:] * 2.0]
    for t in range(4):
        buffers[t % 2][1:] += buffers[(t + 1) % 2][:-1]
    return np.sum(buffers[0] * buffers[1])


def counter_behind_its_loop(x):
    levels = [x.copy(), x[::2] * 1.0]
    s = 0.0
    for k in range(2):
        s += levels[k - 1][k]
    return s * levels[k][0]


def left_early(x):
    levels = [x.copy(), x[::2] * 1.0]
    s = 0.0
    for k in range(2):
        if x[k] > 0.5:
            break
        s += levels[k][0]
    return s


def cases():
    for kernel in (summed, down_and_up, allocated, nested, bound_anew, of_one_size):
        yield Case(kernel, (given(8),), ("x",))
        if kernel is not allocated:
            yield Case(kernel, (given(4).astype(np.float32),), ("x",))
    # which array is meant is known
    for kernel in (counter_behind_its_loop, left_early):
        yield Case(kernel, (given(8),), ("x",))
