"""Subscripts, ranges and remainders: what is simplified, hoisted or split is an integer, by its type."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case

X5, X6 = np.array([0.3, 0.7, 1.1, 2.5, 0.9]), np.array([0.31, -0.72, 1.13, 2.54, 0.95, -1.6])


def negative_divisor(x, n, k):
    s = 0.0
    for j in range(n):
        s += x[j] * x[k % -3]
    return s


def divisor_that_may_be_zero(x, n, k, m):
    s = 0.0
    for j in range(n):
        if m != 0:
            s += x[j] * x[k % m]
        s += x[j] if m == 0 else x[k % m]
    return s


def remainder_of_floats(x, y, a, n):
    for j in range(n):
        y[j] = x[j] * ((j + a) % n)
    for j in range(n):
        y[j] += x[j] * ((j + 0.5) % n) * x[int(a % 3.0)]


def sum_of_floats(x, y, a):
    y[0] = x[int(math.floor(a + 1 - 1))] * a


def bools(x, m, y):
    flag = x[0] > 0.0
    y[flag * 1] = x[1] * x[1]
    y[flag + 2] = x[2] * x[1]
    y[flag + 0] += x[1] * x[2]
    y[flag ** 1] *= x[2]
    for i in range(2):
        y[m[i] * 1] += x[1] * x[i]
    for i in range(flag * 1):
        y[i] *= x[1] * x[1]
    for i in range(flag + 1 - 1):
        y[i + 1 - 1] *= x[1] * x[3]


def above(x):
    return x[0] > 0.5


def bools_of_calls(x, y):
    t = y[bool(x[0] > 0.2) * 1] * x[1] + y[math.isclose(x[1], 1.2) * 1] * x[0] + y[above(x) + 0] * x[2]
    y[above(x) * 1] *= 2.0
    y[math.isfinite(x[0]) ** 1] += y[above(x) * 1] * x[2] + t


def stored_into_itself(x, p, y):
    p[p] = np.arange(4)
    y[0] = np.sum(x[p] * y)


def stored_from_itself(x, p, y):
    p[p] = p[::-1]
    y[0] = np.sum(x[p] * y)
    p[p] += 1
    y[1] = np.sum(x[p] * y)
    p[...] = p % 4
    q = p
    p[:2][q[:2] % 2] = 3
    p[p[1:3]] = p[:2]
    y[2] = np.sum(x[p] * y)


def rows_that_are_sought(x, k):
    x[k:][np.argmax(x[k:, k])] *= -2.0
    x[np.argmax(x[k:, k])] *= -1.5
    x[k:][np.argmax(x[k:, k])] = x[k:][np.argmax(x[:, k] * x[0, 1]) - 1] * 3.0
    below = x[k:]
    below[np.argmin(x[k:, k])] -= x[0] * x[np.argmax(x[k])]


def of_another_type_inside(x, y, k):
    k = np.float64(k)
    for j in range(x.size):
        y[j] = x[j] * x[int((j + k) % x.size)]


def cases():
    yield Case(negative_divisor, (X5, 4, 5), ("x",))
    for m in (0, -3):
        yield Case(divisor_that_may_be_zero, (X5, 4, 5, m), ("x",))
    yield Case(remainder_of_floats, (X5, X6, 0.3, 5), ("x",), ("y",))
    yield Case(sum_of_floats, (X5, np.zeros(1), 0.9999999999999999), ("x",), ("y",))
    yield Case(bools, (X5, np.array([True, False]), np.zeros(4)), ("x",), ("y",))
    table = np.array([[0.3, 0.7, 1.1], [0.5, 2.5, 0.9], [0.31, -0.72, 1.13]])
    yield Case(rows_that_are_sought, (table, 1), ("x",), ("x",))
    yield Case(bools_of_calls, (X5, np.arange(1.0, 5.0)), ("x",), ("y",))
    for kernel in (stored_into_itself, stored_from_itself):
        yield Case(kernel, (X5, np.array([1, 2, 0, 3]), np.arange(1.0, 5.0)), ("x",), ("y",))
    # a parameter that becomes a float
    yield Case(of_another_type_inside, (X5, np.zeros(5), 2), ("x",), ("y",))
