"""Comprehensions through tuples and lists that are written out, also by zip and enumerate."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X, Y = np.array([0.3, 1.1, 0.7]), np.array([0.4, -0.2, 0.9])


def unpacked(x, y):
    p, q = [v ** 2 for v in (x, y)]
    r, s = [np.sin(v) for v in (p.sum(), q[0])]
    return (p * q).sum() * r - s


def stacked(x, y):
    b = x + y
    s = np.stack([np.exp(v) for v in (x, y, b)])
    return (s[0] * s[1] * s[2]).sum() + np.concatenate([v * v[0] for v in [x, y * 2]]).sum()


def weighted(x, y):
    terms = [w * q for w, q in zip((0.1, -0.6), (x, y * x))]
    first, second = [np.sin(k * v) + v for k, v in enumerate([x, y])]
    return (terms[0] * terms[1] + first * second).sum()


def changed(x, i):
    x[i] = x[i] ** 2
    return x[i]


def in_order(x, y):
    z = x * 1.0
    a, b = [changed(z, 0) * v for v in (z[0], z[0] + y[1])]     # both items are taken before the first call
    return a * b + z[0]


def nested(x, y):
    m = np.array([[np.sum(u * v) for u in (x, y)] for v in (x, y)])
    return m[0, 1] * m[1, 1]


def captured(x, y):
    k = 2.0
    a, b = [np.sum(np.array([k * v * j for k in y])) for v, j in ((x[0], k), (k, x[1]))]
    return a * b


def shortest(x, y):
    made = [u * v for u, v in zip((x, y, x), (y[0], x[1]))]
    return made[0] @ made[1] * len(made)


def in_a_loop(x, y):
    s = 0.0
    for i in range(3):
        a, b = [v[i] ** 2 for v in (x, y)]
        s += a * b * i
    return s


def doubled(u):
    u[0] = u[0] * 2.0
    return u[0]


def writes_in_between(x, y):
    x, y = x * 1.0, y * 1.0
    p, q = [v * w for v, w in zip((1.0, doubled(x)), (x[0], 1.0))]
    made = [v * w for v, w in zip((1.0, np.sum(y)), (doubled(y), 1.0))]
    more = [k * v * w for k, (v, w) in enumerate(zip((x[1], doubled(x), x[0]), (x[0], doubled(x), x[2])))]
    return p + 3.0 * q + made[0] * made[1] + more[0] + more[1] * more[2]


def mixed(x, y):
    p, q, r = [v * 2.0 for v in (x, y)]
    return p[0] * q[0] * r[0]


def left_over(x, y):
    made = [v * w for v, w in zip((x[0], x[1]), (x[2], y[0], doubled(y)))]
    return made[0] * made[1] * y[0]


def cases():
    for kernel in (unpacked, stacked, weighted, in_order, nested, captured, shortest, in_a_loop, writes_in_between):
        yield Case(kernel, (X, Y), ("x", "y"))
    # sizes and types
    yield Case(unpacked, (X[:1], Y[:1]), ("x", "y"))
    yield Case(weighted, (X[:0], Y[:0]), ("x", "y"))
    yield Case(stacked, (X.astype("float32"), Y.astype("float32")), ("x", "y"))
    yield Case(left_over, (X, Y), "x", of=("y", "return"))
    # what is left over may write; too few values
    yield Case(mixed, (X, Y), "x", refused="S203 at `p, q, r`: 3 targets for 2 values")
