"""Loops and comprehensions through written functions, and dicts that are made over the keys of others."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.8, 0.2, 0.4])


def square(z):
    return z ** 2 + 1.0


def functions_in_turn(x, n):
    e = np.array([f(x[0]) for f in (np.sin, np.cos, np.exp)])
    s = sum(f(x[1]) for f in [np.tanh, square])
    for k in range(n):
        for f, w in ((np.sin, 2.0), (square, 0.5)):
            x[k] += w * f(x[k])
            s += np.sum(f(x)) * w
    return s * (e @ e)


def dicts(x, n):
    p = {"a": x[:2].copy(), "b": np.outer(x[:2], x[2:4])}
    m = {k: np.zeros_like(p[k]) for k in p}
    for _ in range(n):
        g = {k: 2.0 * v for k, v in p.items()}
        for k in p:
            p[k] -= 0.1 * g[k] ** 2
            m[k] = 0.5 * m[k] + p[k]
    q = {k: v for k, v in p.items()}    # the arrays themselves
    for k in p:
        p[k][0] *= 2.0
        q[k] += m[k]
    return np.sum(m["b"] @ p["a"]) + np.sum(p["b"])


def changed_meanwhile(x):
    s = 0.0
    for f, w in ((np.sin, 2.0), (np.cos, x[1])):        # Python reads x[1] before the loop
        x[1] = w * f(x[0])
        s += x[1]
    return s


def read_behind(x):
    s = 0.0
    for f in (np.sin, np.cos):
        s += f(x[0])
    return s * f(x[1])


def grown(x):
    p = {"a": x[:2].copy(), "b": x[2:4].copy()}
    p["c"] = x[4:6]
    g = {k: 2.0 * p[k] for k in p}
    return np.sum(g["a"] * g["c"])


def grown_in_a_loop(x):
    p, s = {"a": x[:2].copy(), "b": x[2:4].copy()}, 0.0
    for k in ("a", "c"):
        p[k] = x[4:6]
    g = {k: 2.0 * p[k] for k in p}
    for k in g:
        s += np.sum(g[k])
    return s


def cases():
    for kernel in [functions_in_turn, dicts]:
        yield Case(kernel, (X.copy(), 3), ("x",))
    yield Case(changed_meanwhile, (X,), "x", of=("x", "return"))
    for kernel in (read_behind, grown, grown_in_a_loop):
        yield Case(kernel, (X,), "x")
