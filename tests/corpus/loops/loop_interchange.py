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


# -- an outer loop that goes into the next one ----------------------------------------------------------------------

def sweep_of_levels(c, a):
    # each column of cells is a chain of its own
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * a[i, j, k] + 0.5 * c[i, j, k - 1] * c[i, j, k - 1]


def two_sweeps(c, a):
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] - 0.3 * a[i, j, k] * c[i, j, k - 1]
    for k in range(c.shape[2] - 2, -1, -1):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * (1.0 + 0.1 * a[i, j, k] * c[i, j, k + 1])


def sum_of_levels(c, a):
    total = 0.0
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * c[i, j, k - 1]
                total += c[i, j, k] * a[i, j, k]
    return total


def from_the_row_before(c, a):
    # what a row needs of the one before is of the level before
    for k in range(1, c.shape[2]):
        for i in range(1, c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * a[i, j, k] + 0.5 * c[i - 1, j, k - 1] ** 2


def from_the_row_behind(c, a):
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0] - 1):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * a[i, j, k] + 0.5 * c[i + 1, j, k - 1] ** 2


def from_the_first_row(c, a):
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * a[i, j, k] + 0.5 * c[0, j, k - 1] ** 2


def from_the_last_row(c, a):
    # counted from the end, the row before the first is the last one
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0] + 1):
            for j in range(c.shape[1]):
                c[i - 1, j, k] = 0.7 * c[i - 1, j, k] * a[i - 1, j, k] + 0.2 * c[i - 1, j, k - 1] ** 2


def triangle_of_levels(c, a):
    for k in range(1, c.shape[2]):
        for i in range(k, c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = 0.5 * c[i, j, k] + 0.3 * c[i, j, k - 1] + a[i, j, k] ** 2


def number_from_cell_to_cell(c, a):
    s = 0.25
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                s = 0.5 * s + c[i, j, k] * a[i, j, k]
                c[i, j, k] = c[i, j, k - 1] * s
    return s


def levels_first(c, a):
    # the array lies so that the loops are right as they are
    for k in range(1, c.shape[0]):
        for i in range(c.shape[1]):
            for j in range(c.shape[2]):
                c[k, i, j] = c[k, i, j] * a[k, i, j] * c[k - 1, i, j]


def with_an_array_of_levels(c, a):
    # all rows read one element of a level
    for k in range(1, c.shape[2]):
        for i in range(c.shape[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = c[i, j, k] * a[0, j, k] * c[i, j, k - 1]


def until_a_number_of_rows(c, a, rows):
    for k in range(1, c.shape[2]):
        for i in range(rows[0]):
            for j in range(c.shape[1]):
                c[i, j, k] = 0.5 * c[i, j, k] + 0.3 * c[i, j, k - 1] + a[i, j, k] ** 2


MOVED = (sweep_of_levels, two_sweeps, sum_of_levels)
STAYING = (from_the_row_before, from_the_row_behind, from_the_first_row, from_the_last_row, triangle_of_levels,
           number_from_cell_to_cell, levels_first, with_an_array_of_levels)
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
    for kernel in (*MOVED, *STAYING):
        of = ("c", "return") if kernel in (sum_of_levels, number_from_cell_to_cell) else ("c",)
        yield Case(kernel, (some(9, 4, 9), some(9, 4, 9)), ("c", "a"), of)
    yield Case(two_sweeps, (some(3, 0, 9), some(3, 0, 9)), ("c", "a"), ("c",))
    for rows in (0, 4):
        yield Case(until_a_number_of_rows, (some(4, 2, 9), some(4, 2, 9), np.array([rows])), ("c", "a"), ("c",))
    for n in (0, 9):
        yield Case(without_rows, (some(9), some(9, 9), n), ("c", "a"), ("a",))
    narrow = some(9).astype(np.float32), some(9, 9).astype(np.float32)
    yield Case(products_of_columns, narrow, ("c", "a"), ("return",), options={"rtol": 2e-2})
