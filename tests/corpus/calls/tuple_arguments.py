"""Tuples and lists under a name that are given to functions of the user's, or captured by nested ones."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([2.0, 3.0, 4.0])
WEIGHTS = (0.5, 2.0, 3.0)


def h(t):
    return t[0] * t[1]


def dot(t):
    return t[0] @ t[1]


def rhs(u, prm):
    a, b = prm
    return -a * u + b


def on(t, c=2.0):
    return h(t) + rhs(c, t)


def put(t, x):
    x[0] = t[0] * t[1]


def filled(t, c):
    for k in range(2):
        t[0][k] = t[1][k] * c


def picked(t, x):
    s = 0.0
    for k in range(3):
        s += t[k] * x[k]
    return s


def weighed(x, w=(0.5, 2.0)):
    return x[0] * w[0] + x[1] * w[1]


def deep(t):
    return t[0][0] * t[0][1] + t[1] * t[0][0]


def mixed(t):
    return t[0] * t[1][0] + t[1][2]


def squares(t):
    s = 0.0
    for v in t:
        s += v * v
    return s * len(t)


def several(x):
    return x[0] * x[2], x[1]


def whole(t):
    return t[0] * t[1][0] + t[1]


def steps(x):
    prm = (x[0], x[1])
    u = x[2]
    for _ in range(3):
        u += 0.1 * rhs(u, prm)
    return u * on(prm) + on(prm, u)


def arrays(x):
    y = x * 1.0
    t = (y, x)
    filled(t, 3.0)
    q = (y[:2], x[1:])
    filled(q, x[0])
    put((x[1], x[2]), y)
    w = whole((x[0], x * x))
    pair = (x[:2], x[1:])
    return y[0] * y[1] + dot(pair) + w[0] * w[1] + mixed((x[0], x))


def lists(x):
    us = [x[0], x[1], x[2]]
    us[1] = us[0] * us[2]
    first = squares(us)
    us[0] = 5.0
    ks = [0.5, 2.0, 3.0]
    m = [[x[0], x[1]], x[2]]
    m[0][1] = x[2]
    return first + squares(us) + picked(us, x) + picked(ks, x) + picked(WEIGHTS, x) + deep(m)


def bound_again(x):
    if x[0] > 1.0:
        t = (x[0], x[1])
    else:
        t = (x[1], x[2])
    us = [x[0], x[1]]
    s = h(t) * rhs(x[2], t)
    for k in range(3):
        s += h(us) * x[k]
        us = [us[1], x[k] * us[0]]
        t = (t[1], x[k])
        s += h(t)
    return s


def parts(x):
    t = (x[0], 3, 2.0)
    ts = [(x[0], x[1]), (x[1], x[2])]
    n = (ts[0], x[2])
    m = n
    rest = (x[0], x[1], x[2])
    pair = (x[0], x[1])
    return picked(t, x) + h(ts[0]) * h(ts[1]) + deep(n) * deep(m) + h(rest[1:]) + weighed(x) + weighed(x, w=pair)


def results(x):
    t = several(x)
    s = h(several(x)) + x[0]
    return s + h(t) + h((t[1], x[0]))


def nested(x):
    t = (x[0], x[1])
    us = [x[0], x[1]]

    def g(v):
        def k(w):
            return t[0] * w
        return k(v) * t[1]

    def f(v):
        return us[0] * v + us[1]
    s = g(x[2])
    for k in range(3):
        us[0] = us[0] * x[k]
        s += f(x[k])
        t = (t[1], x[k])
        s += g(2.0)
    last = lambda v: us[0] * v  # noqa: E731
    us[0] = x[2]
    return s + last(1.0)


def numbers(x, c):
    t = (c, x[1])
    q = [c, c * 2.0]
    return h(t) * h(q) + t[0] * q[1]


def picks(a, ks):
    return a[ks][0] @ a[ks][1] + np.sum(a[:, ks])


def stores(a, ks, c):
    a[ks] = c


def places(x):
    return [0, 2]


def subscripts(x):
    a = x[:, None] * x[None, :] + 1.0
    rows = places(x)
    ks = [0, 2]
    ones = [1, 0]

    def g(v):
        return np.sum(a[ones] * v)
    s = picks(a, [0, 1]) + picks(a, ones) + picks(a, rows) + picks(a, places(x)) + g(x[0])
    stores(a, ones, x[1])
    return s + np.sum(a[ks]) * a[0, 2]


def from_rows(x):
    s = 0.0
    for t in zip(x, x * x):
        s += h(t)
    return s


def joined(x):
    t = (x[0], x[1]) + (x[2],)
    return picked(t, x)


def write(us):
    us[0] = 2.0 * us[1]


def written(x):
    us = [x[0], x[1]]
    write(us)
    return us[0]


def of_two(a, b):
    return a * b


def of_rows(x):
    s = 0.0
    for row in x:
        s += of_two(*row)
    return s


def cases():
    for kernel in (steps, arrays, lists, bound_again, parts, results, nested, subscripts):
        yield Case(kernel, (X,), ("x",))
    yield Case(numbers, (X, 1.5), ("x", "c"))
    for kernel in (from_rows, joined, written):
        yield Case(kernel, (X,), "x")
    yield Case(of_rows, (np.ones((3, 2)),), ("x",))
    yield Case(of_rows, (np.ones((2, 3)),), ("x",), refused=(
        "S201 at `of_two(*row)`: 'of_two' takes 2 arguments, and is given 3"))
