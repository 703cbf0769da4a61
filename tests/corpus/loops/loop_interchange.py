"""Nests whose inner loop runs along columns: those that change places, and those that must not."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def rank_k(c, a, alpha):
    # the rows of two increments are one where i is j; a sum beside them
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            c[i, :i + 1] += alpha * a[i, k] * a[:i + 1, k]


def rank_k_backwards(c, a):
    for k in range(a.shape[1] - 1, -1, -1):
        for j in range(a.shape[0] - 1, 0, -1):
            c[j] += a[j, k] * a[j - 1, k]


def neighbours(c, a):
    # two iterations of the outer loop meet in an element
    for k in range(1, a.shape[1]):
        for j in range(a.shape[0]):
            c[j] += a[j, k] * a[j, k - 1] ** 2


def stored_along_columns(a, x):
    # iterations of the outer loop need what earlier ones stored
    for k in range(1, a.shape[1]):
        for j in range(a.shape[0]):
            a[j, k] = a[j, k] * a[a.shape[0] - 1 - j, k - 1] + x[j]


def from_the_end(c, a):
    # the first of the columns is the last one, which a later iteration stores again
    for k in range(a.shape[1] + 1):
        for j in range(a.shape[0]):
            a[j, k - 1] = 0.5 * a[j, k - 1] * c[j] + 0.05 * j
            c[j] = 0.9 * c[j] + a[j, k - 1] * c[j] * 0.1


def triangle(c, a):
    for k in range(a.shape[1]):
        for j in range(k, a.shape[0]):
            c[j] += a[j, k] * a[k, k]


def flowing(c, a):
    s = 0.25
    for k in range(a.shape[1]):
        for j in range(a.shape[0]):
            s = 0.5 * s + a[j, k] * c[j]
            a[j, k] = a[j, k] * s
    return s


def bound_of_none(c, a, rows):
    # where the outer loop has no iteration, the bound of the inner one is not there
    for k in range(a.shape[1]):
        for j in range(rows[0]):
            c[j] += a[j, k] * a[0, k]


def left_behind(c, a):
    last = 0.0
    for k in range(a.shape[1]):
        for j in range(a.shape[0]):
            last = a[j, k] * c[j]
            if last > 0.5:
                c[j] += last * a[0, k]
    return last * last


def cases():
    rng = generator(12)

    def some(*shape):
        return rng.uniform(0.4, 1.2, shape)

    yield Case(rank_k, (some(9, 9), some(9, 9), 1.3), ("c", "a", "alpha"), ("c",))
    yield Case(rank_k, (some(3, 3).astype(np.float32), some(3, 9).astype(np.float32), 1.3), ("c", "a"), ("c",),
               options={"rtol": 2e-2})
    for kernel in (rank_k_backwards, neighbours, stored_along_columns, from_the_end, triangle, flowing, left_behind):
        names = ("a", "x") if kernel is stored_along_columns else ("c", "a")
        shapes = (some(9, 9), some(9)) if kernel is stored_along_columns else (some(9), some(9, 9))
        returned = {flowing: ("a", "return"), left_behind: ("c", "return"), stored_along_columns: ("a",)}
        yield Case(kernel, shapes, names, returned.get(kernel, ("c",)))
    yield Case(bound_of_none, (some(4), some(4, 9), np.array([4])), ("c", "a"), ("c",))
    yield Case(bound_of_none, (some(4), some(4, 0), np.zeros(0, int)), ("c",), ("c",))
