"""Slices up to the counters of loops: within the array for all of them, beyond an end, or counted from the end."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def within(x, y):
    for k in range(1, x.shape[0]):
        y[k] += np.sum(x[:k]) * x[k]


def to_the_end(x, y):
    for k in range(x.shape[0] + 1):
        x[k:] *= 1.5 - 0.1 * x[k - 1]
        y[0] += np.sum(x[k:])


def beyond_the_end(x, y):
    for k in range(x.shape[0] + 3):
        x[k:] *= 1.5 - 0.1 * x[0]
        y[0] += np.sum(x[k:])


def from_before_the_beginning(x, y):
    # x[:-1] are all but the last one
    for k in range(-1, x.shape[0]):
        y[k] += np.sum(x[:k]) * x[k]


def downwards(x, y):
    for k in range(x.shape[0] - 1, -2, -1):
        y[k] += np.sum(x[:k]) * x[k]


def flipped(x, y):
    for k in range(1, x.shape[0]):
        x[:k] += 0.3 * np.flip(x[:k])
        y[k] = x[k] * x[0]


def of_another_size(x, y):
    for k in range(x.shape[0]):
        y[:k] *= x[k]
        x[k:] *= np.sum(y[k:]) + 0.1


def moved(x, y, d):
    for k in range(1, x.shape[0] - 1):
        y[k - 1:k + 2] *= x[k - 1:k + 2] + 0.1
        y[k + d:] *= x[k + d:]


def bounds_that_an_iteration_moves(x, y):
    low = 0
    for k in range(x.shape[0]):
        low = low + 2
        y[k] += np.sum(x[:low]) * x[k]


def cases():
    rng = generator(83)

    def some(*shape):
        return rng.uniform(0.4, 1.2, shape)

    for kernel in (within, to_the_end, beyond_the_end, from_before_the_beginning, downwards, flipped,
                   bounds_that_an_iteration_moves):
        yield Case(kernel, (some(5), some(5)), ("x", "y"), ("y",))
    for n in (3, 7):
        yield Case(of_another_size, (some(5), some(n)), ("x", "y"), ("x", "y"))
    for d in (-2, 0, 4):
        yield Case(moved, (some(5), some(5), d), ("x", "y"), ("y",))
