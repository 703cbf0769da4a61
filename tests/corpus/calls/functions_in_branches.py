# ruff: noqa: E731, B023, PLW0108
"""Functions that are defined in branches and loops, or several times."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 1.1, 0.7])


def branches(x, a, opt):
    if opt == 1:
        g = lambda d: d * a
    elif opt == 2:
        g = lambda d: d / a
    else:
        def g(d):
            return np.sin(d) + a
    return g(x).sum() * g(x[0])


def chosen(x, a, opt):
    g = (lambda d: d * a) if opt == 1 else (lambda d: np.exp(d)) if opt == 2 else (lambda d: d - a)
    return (g(g(x)) ** 2).sum()


def looped(x, a, opt):
    s = 0.0
    for i in range(opt + 1):
        g = lambda q: a * q ** 2 + i
        s += g(x[i])
        a = a * 1.1
        s *= g(x[0])
    return s


def again(x, a, opt):
    g = lambda d: d * a
    s = g(x[0])
    for i in range(opt):
        s += g(x[i])
        if i == 1:
            def g(d):
                return d ** 2 / a
    a = s * 2.0
    return s * g(x[2])


def writing(x, a, opt):
    y = x * 1.0
    if opt == 1:
        def g(v):
            v[0] *= 2.0 * a
    elif opt == 2:
        def g(v):
            v[1:] += v[0] * a
    else:
        def g(v):
            v[:] = a * v ** 2
    g(y)
    for k in range(opt):
        g(y)
        if k == 1:
            def g(v):
                v[2] -= a * x[0]
    y.fill(a) if opt > 7 else g(y)
    return np.sum(y * x)


def calling_each_other(x, a, opt):
    if opt == 1:
        def g(q):
            return q * a

        def h(q):
            return g(q) * x[:2]
    else:
        g = lambda q: q ** 2 / a
        h = lambda q: g(q) + g(x[1]) * x[1:]
    for k in range(2):
        def late(q):
            return h(g(q)) * k
    return np.sum(h(x[2])) + np.sum(late(x[0]))


def own_names(x, a, opt):
    if opt > 1:
        k = x[0] * 2.0
        g = lambda d: d * k
    else:
        m = x[1]
        g = lambda d: d + m * a
    s = 0.0
    for i in range(3):
        s += g(x[i])
    return s


def steps(f, x, dt, n):
    for _ in range(n):
        x = x + dt * f(x)
    return x


def handed(x, a, opt):
    if opt == 1:
        f = lambda y: -a * y
    else:
        f = lambda y: a * y * (1.0 - y)
    return steps(f, x, 0.1, 3).sum() + steps(f, x[0], 0.2, 2)


def at_its_definition(x, a, opt):
    s = 0.0
    for i in range(opt):
        g = lambda q, k=i: a * q ** k
        s += g(x[i])
    return s


def kept(x, a, opt):
    fs = [np.sin]
    for _ in range(opt):
        g = lambda q: a * q
        fs.append(g)
    return x[0]


def by_values(x, a, opt):
    if x[0] > 0.2 * opt:
        g = lambda d: d * a
    elif x[1] > 1.0:
        g = np.sin
    else:
        def g(d):
            return d ** 2
    h = g if x[2] > 0.5 else (lambda d: g(d) ** 2)
    return h(x).sum() * g(x[0]) * h(x[1])


def failing(x):
    raise ValueError("too small")


def failing_on_one_way(x, p):
    s = 0.0
    if x[0] > 0.0:
        s = x[1] * p["a"] if x[2] > 0.1 else failing(x)
        s = s * 2.0 if x[2] > 0.2 or failing(x) > 1.0 else s
    return s


def cases():
    for kernel in (branches, chosen, looped, again, writing, calling_each_other, own_names, handed):
        for opt in (1, 2):
            yield Case(kernel, (X, 1.3, opt), ("x", "a"))
    yield Case(branches, (X, 1.3, 3), ("x", "a"))
    for opt in (1, 2):
        yield Case(by_values, (X, 1.3, opt), ("x", "a"))
    yield Case(by_values, (X[::-1] - 0.4, 1.3, 3), ("x", "a"))
    # sizes and types
    yield Case(handed, (X[:1], 1.3, 1), ("x", "a"))
    yield Case(chosen, (X[:0], 1.3, 2), ("x", "a"))
    yield Case(branches, (X.astype("float32"), 1.3, 1), ("x",))
    for kernel in (at_its_definition, kept):
        yield Case(kernel, (X, 1.3, 2), "x")
    yield Case(failing_on_one_way, (X, {"a": 1.3}), "x")
