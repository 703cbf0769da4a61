"""Loops that add to one element of a shadow, and to others that may be the same one."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def row_and_element(y, m):
    # the element is one of the row where i is k
    for k in range(m.shape[0]):
        for i in range(m.shape[0]):
            for j in range(m.shape[1]):
                y[i, j] += m[i, k] * m[k, j]


def one_element_by_two_names(y, x, k):
    # x[k] and x[k - n] are the same one, or not
    for j in range(y.size):
        y[j] += x[k] * x[k - x.size] + x[j] ** 2 * x[0]


def read_beside(x, w):
    # the sum is read where it grows
    for i in range(1, x.size):
        for j in range(w.size):
            x[i] = x[i] + w[j] * x[i - 1]
            w[j] = w[j] * x[i]


def relaxed(path):
    for k in range(path.shape[0]):
        path[:] = np.minimum(path[:], np.add.outer(path[:, k], path[k, :]))


def cases():
    rng = generator(8)

    def some(*shape):
        return rng.uniform(0.4, 1.2, shape)

    yield Case(row_and_element, (some(4, 4), some(4, 4)), ("y", "m"), ("y",))
    yield Case(row_and_element, (some(3, 0), some(3, 0)), ("y",), ("y",))
    yield Case(row_and_element, (some(3, 3).astype(np.float32), some(3, 3).astype(np.float32)), ("m",), ("y",),
               options={"rtol": 2e-2})
    for k in (0, 2, 4):
        yield Case(one_element_by_two_names, (some(5), some(5), k), ("y", "x"), ("y",))
    yield Case(read_beside, (some(4), some(3)), ("x", "w"), ("x", "w"))
    yield Case(relaxed, (rng.uniform(0.1, 3.0, (5, 5)),), ("path",), ("path",))
