"""Helpers that are given several parts of one array and write one: parts that lie apart, and parts that may not."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

X = np.array([0.3, 1.2, 0.8, 0.5, 0.9, 1.4])
A = generator(1).normal(size=(4, 5))


def mix(p, q):
    p[:] = 0.5 * (p + q * q)
    q[0] = p[1] * q[1]


def scale(p, q):
    p[:] *= q[0]


def halves(x):
    mix(x[:3], x[3:])
    mix(x[3:], x[:3])


def at_a_size(x, n):
    for _ in range(2):
        mix(x[:n], x[n:])


def thirds(x):
    m = x.size // 3
    mix(x[:m], x[m:2 * m])
    mix(x[2 * m:], x[m:2 * m])


def rows(a):
    for k in range(a.shape[0] - 1):
        mix(a[k], a[k + 1])


def rows_backwards(a):
    for k in range(a.shape[0] - 1, 0, -1):
        mix(a[k], a[k - 1])


def row_and_rest(a):
    for k in range(a.shape[0] - 1):
        scale(a[k + 1:], a[k])


def last_rows(a):
    mix(a[-1], a[-2])


def columns(a):
    for j in range(a.shape[1] - 1):
        mix(a[:, j], a[:, j + 1])


def ends(x):
    scale(x[:-1], x[-1:])


CASES = [(halves, (X,)), (at_a_size, (X, 3)), (thirds, (X,)), (rows, (A,)), (rows_backwards, (A,)),
         (row_and_rest, (A,)), (last_rows, (A,)), (columns, (A,)), (ends, (X,))]


def overlapping(x):
    mix(x[:4], x[3:])


def overlapping_rows(a, k):
    mix(a[k], a[k + 1])


def first_and_last(a):
    mix(a[0], a[-1])


def on_other_axes(a):
    mix(a[0], a[..., 1])


def strided(x):
    mix(x[::2], x[1::2])


def cases():
    # gradients
    for kernel, arguments in CASES:
        name = "x" if arguments[0] is X else "a"
        yield Case(kernel, arguments, (name,), (name,))
    yield Case(overlapping_rows, (A, 1), "a", of=("a",))
    yield Case(first_and_last, (A,), "a", of=("a",))
    yield Case(strided, (X,), "x", of=("x",))
    # elements in common
    yield Case(overlapping, (np.linspace(0.5, 1.5, 7),), "x", of=("x",))
    yield Case(on_other_axes, (A[:, :4].copy(),), "a", of=("a",))
