"""Spellings that are read as plainer ones, and what is said of those that are not."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X, M = np.array([0.3, 0.7, 1.1, 2.5, 0.9]), np.array([[0.3, 0.7, 1.1], [0.5, 2.5, 0.9]])


def product(d):
    return d["a"] * np.sum(d["b"])


def several(x, m):
    a, b, *_ = x
    *_, c, d = x
    b, *_, a = x
    rows, *_ = m.shape
    total = 0.0
    for i, j in np.ndindex(*m.shape):
        total += m[i, j] * x[i] / rows
    made = dict(a=x[0], b=x[1:])  # noqa: C408
    squares = product(dict(a=x[1], b=m * m))  # noqa: C408
    return total * a * b + c * d * made["a"] * np.sum(made["b"]) + squares


def rest_that_is_read(x, m):
    first, *rest = x
    return first * np.sum(rest)


def one_index(x, m):
    total = 0.0
    for place, value in np.ndenumerate(m):
        total += value * x[place[0]]
    return total


def cases():
    # derivatives
    yield Case(several, (X, M), ("x", "m"))
    yield Case(rest_that_is_read, (X, M), ("x", "m"))
    yield Case(one_index, (X, M), ("x", "m"))
