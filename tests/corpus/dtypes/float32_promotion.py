"""Float32 arrays that meet wider dtypes, where NumPy's dtype is not known."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

A, P = np.float32([0.5, 1.7, 2.2]), np.array([1.5, 2.5, 3.5])
BIG = np.array([1e8])


def kept(a, s):
    return np.sum((a + s - s) ** 2)


def given_an_element(a, p):
    return kept(a, p[0])


def edges_from_an_end(a, p):
    return np.histogram(a, bins=2, range=(p[0], 3))[1]


def run_again(m, total, n):
    # the stack of an inner loop that runs again in the reverse sweep is counted by an integer
    for _i in range(4):
        for j in range(0, n, 2):
            m[...] -= np.float32(0.3) * (m - np.tanh(m))
            total[j % 2] += np.tanh(m[j % 3]) * total[1]
    return np.sum(total)


def cases():
    yield Case(run_again, (A, np.ones(2, np.float32), 5), ("m", "total"), ("return",))
    # a function that is given a number of NumPy's
    yield Case(given_an_element, (A, P), ("a",))
    # edges in a precision that is not known
    yield Case(edges_from_an_end, (A, P), of=None, refused=(
            "S301 at `np.histogram(a, bins=2, range=(p[0], 3))`: no derivative rule for numpy.histogram: give "
            "numbers with one axis, and a number of bins or an array of edges"))
