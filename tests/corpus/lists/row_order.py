"""A list of the rows of an array is a part of it only if it holds them in their order, from its first row on."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

A = np.array([[0.9, 0.31, 1.4], [0.55, 1.13, 0.7], [0.2, 0.4, 1.7], [0.8, 1.2, 0.6]])
X = np.array([0.7, 1.2, 0.4])


def last_first(a, x):
    n = 3
    rows = [None] * n
    for j in range(n):
        rows[n - 1 - j] = a[j]
    a[0, 0] = 9.0 * x[1]
    return rows[2][0] * x[2]


def one_before(a, x):
    n = 3
    rows = [None] * n
    for j in range(n):
        rows[j - 1] = a[j]
    a[0, 0] = 9.0 * x[1]
    return rows[2][0] * x[2]


def not_from_the_first_place(a, x):
    n = 3
    rows = [None] * n
    for j in range(1, n):
        rows[j] = a[j]
    rows[1][0] = 9.0 * x[1]
    return np.sum(a ** 2)


def turned_around(a, x):
    n = 3
    rows = [None] * n
    for j in range(n):
        rows[(j + 1) % n] = a[j]
    a[0, 0] = 9.0 * x[1]
    return rows[1][0] * x[2]


def places_of_an_array(a, x):
    n = 3
    q = [2, 0, 1]
    rows = [None] * n
    for j in range(n):
        rows[q[j]] = a[j]
    a[0, 0] = 9.0 * x[1]
    return rows[2][0] * x[2]


def from_the_end(a, x):
    n = 3
    rows = []
    for j in range(n - 5, n - 1):
        rows.append(a[j])
    a[0, 0] = 9.0 * x[1]
    return rows[2][0] * x[2]


def from_a_written_row_of_the_end(a, x):
    rows = []
    for j in range(-2, 1):
        rows.append(a[j])
    a[0, 0] = 9.0 * x[1]
    return rows[2][0] * x[2]


def the_row_before(a, x):
    rows = [a[j - 1] for j in range(3)]
    a[0, 0] = 9.0 * x[1]
    return rows[1][0] * x[2]


def in_order(a, x):
    n, low = 3, 1
    first = [None] * n
    second = [None] * n
    third = [None] * n
    fourth = []
    for j in range(n):
        first[j] = a[j]
    for j in range(1, n + 1):
        second[j - 1] = a[j]
    for j in range(low, n + low):
        third[j - low] = a[j]
    for j in range(n - 2, x.shape[0]):
        fourth.append(a[j])
    a[1, 0] = 9.0 * x[1]
    second[1][1] = 2.0 * x[0]
    return first[1][0] * second[0][0] + third[0][0] * fourth[0][0] * first[2][1]


def cases():
    for kernel in (
            last_first, one_before, not_from_the_first_place, turned_around, places_of_an_array,
            from_the_end, from_a_written_row_of_the_end, the_row_before):
        yield Case(kernel, (A, X), "x", of=("a", "return"))
    # other orders are refused
    # the order of the array
    yield Case(in_order, (A, X), ("a", "x"), ("return", "a"))
