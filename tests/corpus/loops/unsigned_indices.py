"""Subscripts that cannot be negative, beside those that count from the end in some iteration."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def shifted_windows(x, y):
    # starts, stops and distances of loops in loops
    for i in range(1, x.size):
        for j in range(i, x.size):
            y[j - i] += x[j] * x[j - i] * y[x.size - 1 - j + i]


def from_an_argument(x, y, k):
    # the start may be negative: then elements are those from the end
    for i in range(k, x.size + min(k, 0)):
        y[i] += x[i] * x[i - k]


def around_the_end(x, y):
    for i in range(x.size):
        y[i] += x[2 * i - x.size] * x[i - 1]
    for i in range(x.size - 1, -2, -1):
        x[i] = x[i] * y[i - 1]


def slices_from_the_end(a, x, k):
    for i in range(-2, x.size):
        x[k:] += x[k:] * a[i, k:]
        a[i, :k] *= x[i]


def start_that_moves(x, y):
    # the bound is another one when the loop has begun
    low = 1
    for i in range(low, x.size):
        y[i - low] += x[i] * x[i - low]
        low = (low + 1) % x.size


def ragged(a):
    # rows of growing length, recorded one behind the other
    for k in range(a.shape[0]):
        for j in range(k + 1, a.shape[1]):
            for i in range(k, a.shape[0]):
                a[i, j] = a[i, j] * a[i, k] + a[k, j] * a[i - 1, j - 1]


def never(x, y, k):
    for j in range(k, 0):
        for i in range(j, 0):
            y[i] += x[i] * x[i - j]
    for j in range(0, k, -1):
        y[j - k - 1] *= x[j - k]


def cases():
    rng = generator(77)

    def some(*shape):
        return rng.uniform(0.4, 1.2, shape)

    for kernel in (shifted_windows, around_the_end, start_that_moves):
        yield Case(kernel, (some(6), some(6)), ("x", "y"), ("x", "y") if kernel is around_the_end else ("y",))
    for k in (-2, 0, 3, 9):
        yield Case(from_an_argument, (some(6), some(6), k), ("x", "y"), ("y",))
        yield Case(slices_from_the_end, (some(6, 6), some(6), k), ("a", "x"), ("a", "x"))
    yield Case(ragged, (some(5, 5),), ("a",), ("a",))
    yield Case(ragged, (some(4, 4).astype(np.float32),), ("a",), ("a",), options={"rtol": 2e-2})
    for k in (-3, 2):
        yield Case(never, (some(5), some(5), k), ("x", "y"), ("y",))
