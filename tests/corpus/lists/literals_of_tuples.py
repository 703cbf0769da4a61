"""A written-out list of tuples under a name holds the arrays themselves: what a loop over it writes is written."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

A = np.array([[0.9, 0.31, 1.4], [0.55, 1.13, 0.7], [0.2, 0.4, 1.7], [0.8, 1.2, 0.6]])
X = np.array([0.7, 1.2, 0.4])


def written_rows(a, x):
    u = x * 2.0
    v = x * 3.0
    ps = [(u, 1.0), (v, 2.0)]
    for p, c in ps:
        p[0] += c * x[1]
    pairs = ((u, v), (v, u))
    for p, q in pairs:
        p[0] += q[1]
    first = (u, 1.5)
    inner = [first, (v, 2.5)]
    for k, (p, c) in enumerate(inner):
        p[1] *= c + k
    deep = [(u, (v, 1.0)), (v, (u, 2.0))]
    for p, (q, c) in deep:
        p[0] += c * q[1]
    return np.sum(u * v)


def rows_of_a_matrix(a, x):
    ps = [(a[0], 1.0), (a[1], x[0])]
    for p, c in ps:
        p[0] += c * x[1]
    return np.sum(a ** 2)


def bound_anew(a, x):
    u, w = x * 2.0, x[0] * 2.0
    ps = [(u, w), (x, x[1])]
    u, w = x * 5.0, x[2]
    s = 0.0
    for p, c in ps:
        s += c * np.sum(p * u) * w
    return s


def cases():
    # gradients
    for kernel, of in ((written_rows, ("return",)), (rows_of_a_matrix, ("return", "a")), (bound_anew, ("return",))):
        yield Case(kernel, (A, X), ("a", "x"), of)
