"""Sizes that a count of an array says hold what it said then: the array of bools may change, what is counted, too."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

X = np.array([0.3, 0.7, 1.1, 2.5, 0.9])
A = generator(1).normal(size=(4, 5))


def one_less(x):
    m = x > 0.8
    a = x[m]
    m[2] = False
    return np.sum(a * a)


def one_more(x):
    m = x > 0.8
    a = x[m]
    m[0] = True
    return np.sum(a * a)


def picked_again(x):
    m = x > 0.5
    a = x[m]
    m &= x < 2.0
    b = x[m]
    return np.sum(a * a) * np.sum(b)


def fewer_each_time(x):
    active = np.ones(5, dtype=bool)
    s = 0.0
    while np.any(active):
        v = x[active]
        k = np.argmax(np.where(active, x, -1e9))
        active[k] = False
        s += np.sum(v * v) * x[k]
    return s


def off(m):
    m[2] = False


def by_a_helper(x):
    m = x > 0.8
    a = x[m]
    off(m)
    return np.sum(a * a)


def negated(x):
    m = x > 0.8
    a = x[m]
    np.logical_not(m, out=m)
    return np.sum(a * a) + np.sum(x[m])


def stored_anew(x):
    m = x > 0.8
    x[m] = x[m] ** 2
    m[:] = ~m
    x[m] *= x[m]
    return np.sum(x)


def rows(a):
    m = a[:, 0] > -5.0
    r = a[m]
    m[0] = not m[0]
    return np.sum((r @ r.T) ** 2)


def place_as_a_size(x):
    k = int(np.argmax(x))
    a = np.zeros(k)
    for i in range(k):
        a[i] = x[i] * x[i]
    x[1] = 9.0 * x[1]
    return np.sum(a * a)


def count_as_a_size(x):
    m = x > 0.8
    w = np.empty(np.count_nonzero(m))
    m[:] = False
    for i in range(w.size):
        w[i] = x[i] * x[i]
    return np.sum(w)


def grow(x):
    x[0] *= 2.0
    return 3


def of_a_helper_that_writes(x):
    n = grow(x)
    w = np.zeros(n)
    w += x[:n]
    return np.sum(w * w) * x[0]


def half(n):
    return n // 2


def of_a_helper(x):
    n = half(x.size)
    w = np.zeros(n)
    for i in range(n):
        w[i] = x[i] * x[0]
    return np.sum(w * w)


def count(x):
    n = 0
    for i in range(x.size):
        if x[i] > 0.8:
            n += 1
    return n


def counted_and_filled(x):
    w = np.zeros(count(x))
    k = 0
    for i in range(x.size):
        if x[i] > 0.8:
            w[k] = x[i] ** 2
            k += 1
    x[:] = 0.0
    return np.sum(w * w)


def part_of_a_count(x):
    n = count(x)
    w = x[:n] * 2.0
    x[:] = x * 0.1
    return np.sum(w * w * x[:n])


TABLE = np.array([[0.3, 0.8, 0.1, 0.5], [0.9, 0.2, 0.7, 0.4], [0.1, 0.6, 0.3, 0.2], [0.5, 0.5, 0.9, 0.7]])


def of_rows_that_are_picked(x):
    places, s = np.argmin(TABLE[:2], axis=1), 0.0
    for k in range(3):
        d = TABLE[places, places] * x[1] * (k + 1)
        s += np.sum(d[d > 0.3] ** 2)
    return s


CASES = [of_rows_that_are_picked, one_less, one_more, picked_again, fewer_each_time, by_a_helper, negated,
         stored_anew, place_as_a_size, count_as_a_size, of_a_helper_that_writes, of_a_helper, counted_and_filled,
         part_of_a_count]


def cases():
    for kernel in CASES:
        yield Case(kernel, (X,), ("x",))
    # rows
    yield Case(rows, (A,), ("a",))
