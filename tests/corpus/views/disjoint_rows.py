"""Rows of one array for a helper that writes one of them: what the loops and branches around say keeps them apart."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([[0.9, 0.31, 1.4], [0.55, 1.13, 0.7], [0.2, 0.4, 1.7], [0.8, 1.2, 0.6]])


def addto(u, v):
    u += 0.5 * v


def rotate(u, v, c):
    for k in range(u.shape[0]):
        t = u[k]
        u[k] = c * t - v[k]
        v[k] = t + c * v[k]


def pairs(x):
    n = x.shape[0]
    for i in range(n):
        for j in range(i + 1, n):
            rotate(x[i], x[j], 0.3)
    for p in range(1, n):
        for q in range(p):
            addto(x[p], x[q])


def backwards(x):
    n, m = x.shape
    for i in range(n):
        for j in range(n - 1, i, -1):
            addto(x[j, 1:], x[i, 1:])
        for k in reversed(range(i)):
            addto(x[i], x[k])
    for k in range(m - 1):
        addto(x[:, m - 1 - k], x[:, m - 2 - k])


def branches(x):
    n = x.shape[0]
    for i in range(n):
        if i > 0:
            addto(x[i], x[i - 1])
        last = i + 1
        for j in range(n):
            if i == j:
                continue
            if j >= last or i < 1:
                rotate(x[i], x[j], 0.2)
            elif not j >= i:
                addto(x[i], x[j])


def of_an_earlier_trip(x):
    for i in range(2):
        if i == 0:
            j = i + 1
        addto(x[i], x[j])


def of_the_trip_before(x):
    k = 0
    for i in range(3):
        if k < i:
            addto(x[i], x[k])
        k = i


def read_above_its_binding(x):
    for i in range(3):
        if i > 1:
            j = m + 1  # noqa: F821
        m = i
        if i > 1:
            addto(x[j], x[m])


def by_floats(x):
    t, b = x[0, 0], x[1, 1]
    for i in range(2):
        for j in range(2):
            if t > b and t < b + 1:
                addto(x[i], x[j])


def counted_from_the_end(x):
    for i in range(-2, 2):
        for j in range(i + 1, 2):
            addto(x[i], x[j])


def perhaps_one_row(x):
    for i in range(x.shape[0]):
        addto(x[i], x[(i + 1) % x.shape[0]])


def cases():
    # rows apart
    for kernel in (pairs, backwards, branches):
        yield Case(kernel, (X,), ("x",), ("x",))
    # rows that may be one, and are
    for kernel in (
            of_an_earlier_trip, of_the_trip_before, read_above_its_binding, counted_from_the_end,
            perhaps_one_row, by_floats):
        yield Case(kernel, (X,), "x", of=("x",))
