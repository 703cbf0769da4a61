"""Small kernels, to test how derivatives are called."""
from __future__ import annotations

import numpy as np

from s2sad import differentiate

G = 2.0
TABLE = np.array([1.0, 2.0, 3.0])
BUFFER = np.zeros(2)


def square(du, u, n=3):
    for i in range(n):
        du[i] = u[i] * u[i]


def scale(u, c):
    for i in range(u.size):
        u[i] = c * u[i]


def norm(u, c=1.0):
    total = 0.0
    for i in range(u.size):
        total += c * u[i] * u[i]
    return total


def dot(x, y):
    total = 0.0
    for i in range(x.size):
        total += x[i] * y[i]
    return total


def grown(u):
    for i in range(u.size):
        u[i] = 3.0 * u[i]
    return u


def pair(x, n):
    return 2.0 * x, n, x * x


def gravity(x):
    return G * x


def looked_up(x, k):
    return x * TABLE[k]


def guarded(u, limit):
    for i in range(u.size):
        u[i] = 2.0 * u[i]
        assert u[i] < limit
    return u[0]


def unused(x, t):
    return 2.0 * x


def both_ways(u, v):
    total = 0.0
    for i in range(u.size):
        u[i] = 3.0 * u[i] * v[i]
        total += u[i]
    return u, total, u.size


def through(out, u, work):
    for i in range(u.size):
        work[i] = u[i] * u[i]
    for i in range(u.size):
        out[i] = 2.0 * work[i]


def read_before(u, work):
    total = 0.0
    for i in range(u.size):
        total += work[i] * u[i]
        work[i] = u[i]
    return total


def many(a, b, c, d, e, f, g, h, out):
    for i in range(a.size):
        out[i] = a[i] * b[i] + c[i] * d[i] + e[i] * f[i] + g[i] * h[i]


def weighted(table, x):
    total = 0.0
    for i in range(table.size):
        total += looked_up(table[i], i) * x
    return total


def buffered(u):
    for i in range(u.size):
        BUFFER[i] = u[i] * u[i]
    return BUFFER[0] * u[1]


def power(x: float, n: int):
    result = 1.0
    for _ in range(n):
        result *= x
    return result


def enclosing(c, table):
    def inner(u):
        total = 0.0
        for i in range(u.size):
            total += c * u[i] * table[i]
        return total
    return inner


@differentiate
def cube(x):
    return x * x * x


@differentiate(engine="numpy", wrt="u")
def cubes(u):
    total = 0.0
    for i in range(u.size):
        total += cube(u[i])
    return total


def asserted_between(u, v):
    w = u * u
    assert w[1, 1] > -1.0
    z = w * v
    assert np.sum(z) > -100.0
    v += z * z
