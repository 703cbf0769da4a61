"""Functions that return arrays and are called more than once write into arrays that they are given."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, -0.9, 0.7, 0.2])
Y = np.array([0.5, 0.1, -0.4, 0.8])
COEFFICIENTS = np.array([0.6, -0.2, 0.9])


def rhs(u, p):
    du = np.zeros_like(u)
    for i in range(u.size):
        du[i] += p * u[i - 1] ** 2
        du[i - 1] -= np.sin(u[i])
    return du


def runge_kutta(x, p):
    for _ in range(2):
        k1 = rhs(x, p)
        k2 = rhs(x + 0.5 * k1, p)
        k3 = rhs(x + 0.5 * k2, p)
        k4 = rhs(x + k3, p)
        x += (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0


def pair(u, v):
    n = len(u)
    a, b = np.zeros(n), np.ones((n,))
    for i in range(1, n):
        a[i] = u[i] * v[i - 1] ** 2
        b[i] -= a[i] * u[i]
    return a, b


def exchanged(x, y):
    for _ in range(3):
        x, y = pair(y, x)
    a, b = pair(x, x)
    return np.sum(a * b) + np.sum(x)


def bound_anew(x, p):
    u = x
    total = 0.0
    for _ in range(3):
        old = u * 1.5
        u = rhs(u, p)
        u[0] = old[1]
        old[2] *= 1.5
        total += np.sum(old * u)
    return np.sum(u) + total


def wider(u, n):
    m = u.shape[0] - 1
    n = n + 1
    w = np.empty((m, n + m))
    for i in range(m):
        for j in range(n + m):
            w[i, j] = u[i] * u[i + 1] + j * u[i] ** 2
    return w


def sizes(x, n):
    a = wider(x, n)
    b = wider(x[1:], n)
    return np.sum(a ** 2) + np.sum(b[:, :n] * a[:-1, :n])


def moving(u):
    w = np.zeros_like(u)
    for i in range(u.size):
        w[i] = u[i] ** 2
        u[i] += 0.5 * w[i - 1]
    return w


def writes_its_argument(x):
    s = np.sum(moving(x) * x)
    if s > -5.0:
        s += np.sum(moving(x)[1:])
    return s + x[0] * np.sum(moving(x[::2]))


def picked(u, k=1):
    w = np.zeros(u.size)
    h = np.zeros_like(w)
    for i in range(u.size):
        h[i] = u[i] ** 2
        w[i - k] = np.exp(-h[i]) * COEFFICIENTS[i % 3]
    return w


def of_defaults(x):
    total = 0.0
    k = 0
    while k < 2:
        total += np.sum(picked(x) * picked(x, k=2)) + np.max(picked(u=x * total))
        k += 1
    return total


def counted(u):
    places = np.zeros(u.size, dtype=np.int64)
    for i in range(u.size):
        places[i] = (2 * i + 1) % u.size
    return places


def singles(u):
    w = np.zeros_like(u)
    w32 = np.zeros(u.size, np.float32)
    for i in counted(u):
        w[i] = u[i] ** 2
        w32[i] = u[i]
    return w, w32


def of_dtypes(x):
    a, b = singles(x)
    c, d = singles(a)
    return np.sum(a[counted(x)] * c) + 0.0 * np.sum(b + d)


def rows(u):
    w = np.zeros(u.shape[1:])
    for i in range(u.shape[0]):
        for j in range(w.shape[0]):
            w[j] += u[i, j] ** 2
    return w


def cut(x):
    u = np.zeros((2, x.size))
    u[0] = x
    return np.sum(rows(u) * rows(u + 1.0))


class Model:
    def __init__(self, p):
        self.p = p

    def rate(self, u):
        r = np.zeros(u.shape)
        for i in range(u.size):
            r[i] = self.p * u[i] ** 2
        return r


MODEL = Model(0.7)


def of_a_method(x):
    k = MODEL.rate(x)
    x[:] = x + MODEL.rate(x + 0.1 * k)


def waves(u, v):
    r = np.where(u > 0.0, u * v ** 2, np.sin(v)) + np.roll(u, 1)
    s = np.clip(r, -0.5, 0.7) * 2.0 - np.exp(-u) * np.roll(v, -1)
    r[1:] += s[:-1] ** 2
    return r, 0.3 * s - r * u + np.maximum(u, v) * np.cos(r) / (1.0 + s ** 2) - np.tanh(v) * np.sqrt(1.0 + r ** 2)


def of_expressions(x, y):
    for _ in range(2):
        a, b = waves(x, y)
        c, d = waves(x + 0.5 * a, y * b)
        x += 0.1 * c
        y -= 0.1 * d * b
    return np.sum(x * y)


def handed_on(u, v):
    p, q = waves(v, u)
    w = rhs(p, 0.5)
    z = rhs(w, 0.1)
    return q, w, z * 1.0


def through(x, y):
    a, b, c = handed_on(x, y)
    d, e, f = handed_on(a + c, b)
    b[0] = 2.0 * e[1]
    return np.sum(a * b + c * d - e) + f[0]


def one_row(u, v):
    w = u * v
    for i in range(u.shape[0]):
        w[i] *= np.sum(v[0])
    return w


def of_one_row(x, y):
    a = np.reshape(x, (1, 4))
    return np.sum(one_row(a, a) * one_row(a + 1.0, np.reshape(y, (1, 4))))


def none_left(x, n):
    return np.sum(wider(x[:1], n)) + np.sum(wider(x, n)) + np.sum(wider(x[:2], 0))


def cases():
    yield Case(runge_kutta, (X, 0.4), ("x", "p"), ("x",))
    yield Case(exchanged, (X, Y), ("x", "y"))
    yield Case(bound_anew, (X, 0.4), ("x", "p"))
    for kernel in (sizes, none_left):
        yield Case(kernel, (X, 2), ("x",))
    yield Case(writes_its_argument, (X,), ("x",), ("return", "x"))
    for kernel in (of_defaults, of_dtypes, cut):
        yield Case(kernel, (X,), ("x",))
    yield Case(of_a_method, (X,), ("x",), ("x",))
    yield Case(of_expressions, (X, Y), ("x", "y"), ("return", "x", "y"))
    for kernel in (through, of_one_row):
        yield Case(kernel, (X, Y), ("x", "y"))
