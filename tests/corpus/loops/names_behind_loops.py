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


def structure_of_the_last_round(x, n):
    r = x
    for it in range(n):
        q = {"a": r * it, "b": [r * r, np.ones(4)]}
        if np.max(r) > 2.2:
            break
        r = 1.1 * r
    return np.sum(q["a"] * q["b"][0]) + np.sum(q["b"][1] * r)


class Pair:
    def __init__(self, first, second):
        self.first, self.second = first, second


def structure_changed_behind_the_exit(x, n):
    r = x[0]
    for it in range(n):
        p = Pair(r * it, [r * r, 3.0])
        if r > 0.8:
            break
        p.second[1] = r
        r = 1.3 * r
    return p.first + p.second[0] * p.second[1] * r


def structure_of_each_exit(x, n):
    r, k = x[0], 0
    while True:
        p = Pair(r * x[1], [r, 2.0])
        k += 1
        if k >= n:
            break
        r = 1.2 * r + x[2]
        if r > 3.0:
            p = Pair(r, [x[3], r * r])
            break
    return p.first * p.second[0] + p.second[1]


def structure_under_two_names(x, n):
    s = 0.0
    for k in range(n):
        p = Pair(x[0] * k, [x[1], 2.0])
        q = p
        if s > 2.0:
            q = Pair(x[2], [x[3], 1.0])
            break
        s += x[k % 4]
    p.second[0] = s
    return q.first * q.second[0] + p.first


def one_of_two_structures(x, n):
    s = 0.0
    for k in range(n):
        p = [x[0] * k, x[1]]
        q = p
        if s > 2.0:
            q = [x[2], x[3]]
            break
        s += x[k % 4]
    return q[0] * q[1] + s


def cases():
    for n in (0, 1, 3):
        yield Case(without_a_round, (X, n), ("x",))
    for kernel in (counter, computed, combined, generated, left, bound_where_it_is_left, otherwise):
        for n in (2, 3, 4):
            yield Case(kernel, (X, n), ("x",))
    yield Case(left, (X - 2.0, 4), ("x",))
    yield Case(otherwise, (4.0 * X, 4), ("x",))
    for kernel in (structure_of_the_last_round, structure_changed_behind_the_exit):
        for n in (1, 3, 7):
            yield Case(kernel, (X, n), ("x",))
    for n in (1, 3, 7):
        yield Case(structure_of_each_exit, (X, n), ("x",))
    for kernel in (structure_under_two_names, one_of_two_structures):
        yield Case(kernel, (X, 4), ("x",), refused=(
            "S201 at `q`: 'q' is bound on one way only: bind it before the branch or the loop, too"))
