"""What loops within loops bind, read behind them where the last rounds of the outer one have none of the inner; `else`
of loops that go through several ranges, or through a generator."""
from __future__ import annotations

import itertools

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 1.4, 0.2, 2.1])


def counter(x, n):
    rates = {"s": 1.0}
    s = rates["s"]
    for i in range(n):
        for j in range(i + 1, n):
            q = i
            s += x[j]
    return s * x[q]


def computed(x, n):
    rates = {"s": 1.0}
    s = rates["s"]
    for i in range(n):
        y = x[i] * 2.0
        for j in range(i + 1, n):
            q = y
            s += x[j]
    return s * q


def combined(x, n):
    s = 0.0
    for i, j in itertools.combinations(range(n), 2):
        s += x[j] * x[i]
    return s * x[i]


def pairs(n):
    for i in range(n):
        for j in range(i + 1, n):
            yield i, j


def generated(x, n):
    s = 0.0
    for i, j in pairs(n):
        s += x[j] * x[i]
    return s * x[i]


def left(x, n):
    s = 0.0
    for i, j in pairs(n):
        s += x[j] * x[i]
        if x[i] > 1.0:
            break
        if x[j] > 2.0:
            continue
        s += x[j]
    else:
        s *= x[0]
    return s * x[i] * x[j]


def rounds(n):
    yield from range(n)


def bound_where_it_is_left(x, n):
    u = x.copy()
    for i in rounds(n):
        u = u * x[1]
        if np.sum(u) > 8.0:
            best = u * i
            break
    else:
        best = x
    return np.sum(best) + np.sum(u)


def otherwise(x, n):
    s = 0.0
    for i, j in np.ndindex(n, 2):
        s += x[i] * x[j]
        if s > 20.0:
            break
    else:
        s *= x[0]
    for k, v in enumerate(x[:n]):
        if v > 2.0:
            s += v * k
            break
    else:
        s *= x[1]
    return s * x[k]


def without_a_round(x, n):
    i, v, s = 2, x[0], 1.0
    for i, v in enumerate(x[:n]):
        s += v * (i + 1)
    while s < 9.0:
        s = s * 1.5
        if s > x[3] * 8.0:
            s += x[2]
            break
    else:
        s *= x[1]
    return s * x[i] * v


def cases():
    for n in (0, 1, 3):
        yield Case(without_a_round, (X, n), ("x",))
    for kernel in (counter, computed, combined, generated, left, bound_where_it_is_left, otherwise):
        for n in (2, 3, 4):
            yield Case(kernel, (X, n), ("x",))
    yield Case(left, (X - 2.0, 4), ("x",))
    yield Case(otherwise, (4.0 * X, 4), ("x",))
