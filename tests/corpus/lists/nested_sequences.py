"""Lists and tuples that are elements of a list: they are joined, repeated and compared as Python does it."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 0.5, 0.9])


def cat(p, q):
    return p + q


def joined(x):
    pairs = [(x[i], x[i + 1]) for i in range(3)]
    quad = pairs[0] + pairs[1]
    rows = []
    for i in range(3):
        rows.append([x[i], x[i + 1] ** 2])
    turned = rows[0][1:] + rows[0][:1]
    twice, thrice = rows[1] * 2, 3 * rows[2]
    y = np.array(rows[0] + rows[1])
    s = cat(rows[0], rows[2])
    longer = pairs[2] + (1.0, x[0])
    for t in pairs:
        u = t + t
        y[0] += u[1] * u[2] * len(u)
    return (quad[0] * quad[1] + turned[0] * turned[1] * len(turned) + twice[1] * twice[2] + thrice[5] * y.size
            + s[0] * s[1] * s[3] + longer[3] * longer[1] + np.sum(y ** 2))


def as_arrays(x):
    rows = [[x[i], x[i + 1]] for i in range(3)]
    whole = np.array(rows)
    y = np.array(rows[0]) * 2 + np.array(rows[1])
    p = np.zeros(2)
    for r in rows:
        p = p + r
        p += r
    m = whole[0] + whole[1] * 2 + rows[2] * y
    return m[0] * y[1] + p[0] * p[1]


def nested(x):
    m = [[x[i] * x[j] for j in range(2)] for i in range(3)]
    s, t = m[0] + m[1], m[1] * 2
    ones = [(x[i],) for i in range(3)]
    b = ones[0] + ones[1]
    return s[0] * s[1] * s[3] * len(s) + t[2] ** 2 + b[1] * len(b)


def as_places(x):
    ts = [(i, i + 1) for i in range(3)]
    u = ts[0] + ts[1]
    s = x[u[1]] * x[u[3]]
    for p in ts:
        for q in ts:
            if p == q or not p:
                continue
            s += x[p[0]] * x[q[1]] ** 2
    if ts[0] and ts[0] != (0, 1):
        s *= 2.0
    return s if ts[0] == (0, 1) else s * s


def dot(p, q):
    return p[0] * q[0] + p[1] * q[1]


def handed(x):
    ts = [(x[i], x[i + 1]) for i in range(3)]
    return dot(ts[0], ts[2])


KERNELS = [joined, as_arrays, nested, as_places, handed]


def longer(x):
    rows = [[x[i], x[i + 1]] for i in range(3)]
    r = rows[0]
    r += rows[1]
    return r[0] * r[1]


def ordered(x):
    ts = [(x[i], 2.0) for i in range(3)]
    best = ts[0]
    for t in ts:
        if t > best:
            best = t
    return best[0] ** 2


def compared_with_another(x):
    ts = [(x[i], 2.0) for i in range(3)]
    rows = [[x[i], 2.0] for i in range(3)]
    return x[0] if ts[0] == rows[0] else x[1]


def repeated(x):
    ts = [(x[i], 2.0) for i in range(3)]
    u = ts[0] * len(x)
    return u[0] * u[2]


def copied(x):
    rows = [[x[i], 2.0] for i in range(3)]
    r = rows[0].copy()
    s = r + r
    return s[0] * s[1]


def inner(p, q):
    r = p + q
    return r[0] * r[1]


def outer(p, q):
    return inner(p, q) ** 2


def added_in_a_function(x):
    ts = [(x[i], x[i + 1]) for i in range(3)]
    return outer(ts[0], ts[1])


def cases():
    # gradients
    for kernel in KERNELS:
        yield Case(kernel, (X,), ("x",))
    for kernel in (longer, ordered, compared_with_another, copied, added_in_a_function, repeated):
        yield Case(kernel, (X,), "x")
