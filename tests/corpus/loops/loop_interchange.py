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


# -- what more is in the outer loop ----------------------------------------------------------------------------------

def products_of_columns(c, a):
    r = np.empty(a.shape[1])
    for j in range(a.shape[1]):
        r[j] = np.dot(c, a[:, j]) * c[0]
    return np.sum(r * r)


def orthogonal(c, a):
    # Gram and Schmidt: an element of column k is one of all iterations
    for k in range(a.shape[1] - 1):
        a[:, k] = a[:, k] / np.sqrt(np.dot(a[:, k], a[:, k]))
        for j in range(k + 1, a.shape[1]):
            r = np.dot(a[:, k], a[:, j]) * c[k]
            a[:, j] -= a[:, k] * r


def symmetric(c, a):
    below = np.empty(a.shape[1])
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            a[:i, j] += 0.3 * a[i, j] * c[:i]
            below[j] = a[:i, j] @ c[:i]
        a[i, :] += a[i, :] * c[i] + 0.5 * below


def handed_on_twice(c, a):
    # the number is another one for the second loop
    for j in range(a.shape[1]):
        s = np.dot(c, a[:, j])
        a[:, j] = a[:, j] * s * 0.1
        s = 0.1 * (s * c[0] + np.dot(c, a[:, j]) * c[1])
        c[2] = c[2] + 0.1 * s
        a[:, j] += c * s


def last_of_a_column(c, a):
    # a number that the inner loop leaves to what stands behind it
    for j in range(a.shape[1]):
        last = c[0]
        for i in range(a.shape[0]):
            last = c[i] * a[i, j]
        a[0, j] = last * a[1, j]


def next_column(c, a):
    # what stands behind the inner loop changes what the next iteration reads
    for j in range(a.shape[1] - 1):
        for i in range(a.shape[0]):
            a[i, j] = a[i, j] * c[i]
        a[0, j + 1] = a[0, j + 1] * a[1, j]


def on_one_way(c, a):
    s = 0.5
    for j in range(a.shape[1]):
        if a[0, j] > 0.8:
            s = a[1, j]
        for i in range(a.shape[0]):
            a[i, j] = a[i, j] * c[i] * s


def numbered_column(c, a):
    # an integer is handed on
    for j in range(a.shape[1]):
        m = (3 * j) % 4
        r = np.dot(c, a[:, j])
        for i in range(a.shape[0]):
            a[i, j] += c[m] * r * a[i, j]


def from_the_last_column(c, a):
    for j in range(a.shape[1]):
        r = np.dot(c, a[:, j - 1])
        for i in range(a.shape[0]):
            a[i, j - 1] = a[i, j - 1] * r


def read_and_summed(c, a):
    # the vector is summed into by one part and read by the other
    for j in range(a.shape[1]):
        r = np.dot(c, a[:, j])
        for i in range(a.shape[0]):
            c[i] += 0.1 * r * a[i, j]
            a[i, j] = a[i, j] * c[0]


def without_rows(c, a, n):
    for j in range(a.shape[1]):
        r = c[0] * a[0, j]
        for i in range(n):
            a[i, j] = a[i, j] * r * c[i]
        a[1, j] = a[1, j] * r


DISTRIBUTED = (products_of_columns, symmetric)
TOGETHER = (orthogonal, numbered_column, handed_on_twice, last_of_a_column, next_column, on_one_way,
            from_the_last_column, read_and_summed)


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
    for kernel in (*DISTRIBUTED, *TOGETHER):
        for columns in (9, 1) if kernel is orthogonal else (9,):
            of = {products_of_columns: ("return",), handed_on_twice: ("c", "a"), read_and_summed: ("c", "a")}
            yield Case(kernel, (some(9), some(9, columns)), ("c", "a"), of.get(kernel, ("a",)))
    for n in (0, 9):
        yield Case(without_rows, (some(9), some(9, 9), n), ("c", "a"), ("a",))
    narrow = some(9).astype(np.float32), some(9, 9).astype(np.float32)
    yield Case(products_of_columns, narrow, ("c", "a"), ("return",), options={"rtol": 2e-2})
