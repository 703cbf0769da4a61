"""Loops over written lists beside arrays, and over parts of written lists."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

V = np.array([0.3, 1.2, 0.8])
A = generator(1).normal(size=(3, 5))


def weights(x, c):
    s = 0.0
    for v, w in zip(x, [1.0, 2.0, -3.0]):
        s += w * v * c
    return s


def rows(x, c):
    s = 0.0
    for v, w in zip(x, (1.0, c, 3.0)):
        s += w * np.sum(v)
    return s


def numbered(x, c):
    s = 0.0
    for i, (v, w) in enumerate(zip(x, [1, 2, 3])):
        s += w * v * c * i
    return s


def neighbours(c):
    xs = [c, c * 2, c * c]
    s = 0.0
    for a, b in zip(xs, xs[1:]):
        s += a * b
    for a in xs[::-2]:
        s += a * a
    return s


def arrays(x, c):
    ws = [x * 2, x * c]
    s = 0.0
    for w, k in zip(ws, (1.0, 2.0)):
        s += k * np.sum(w ** 2)
    return s


CASES = [(weights, (V, 1.3), ("x", "c")), (rows, (A, 1.3), ("x", "c")), (numbered, (V, 1.3), ("x", "c")),
         (neighbours, (1.3,), ("c",)), (arrays, (V, 1.3), ("x", "c"))]


def cases():
    for kernel, arguments, wrt in CASES:
        yield Case(kernel, arguments, wrt)
