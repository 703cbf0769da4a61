"""Arrays in lists: Python's lists hold the arrays themselves, here they are copied, which must not show."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def scale(v):
    v *= 2.0


def new_in_every_turn(a, x):
    first, second, third = [], [], []
    for k in range(3):
        w = np.zeros(2)
        for j in range(2):
            w[j] += x[k] * a[k, j]
        first.append(w)
    for k in range(3):
        v = a[k].copy()
        v[0] += x[k]
        v *= 2.0
        scale(v)
        if k != 1:
            v[1] += x[0]
            second.append(v)
        third.append(x * a[k])
    third[1][0] = x[0]
    s = 0.0
    for w in first:
        s += w[0] * w[1] + second[1][0]
    return s + np.sum(np.array(second) ** 2) + np.sum(np.array(third) ** 2)


def row_of_the_list_written(a, x):
    rows, s = [], 0.0
    for k in range(3):
        w = x * a[k, 0]
        rows.append(w)
        rows[k][0] = 5.0 * x[1]
        s += w[0]
    return s + np.sum(np.array(rows) ** 2)


def rows_written_in_a_loop(a, x):
    rows = []
    rows.append(x)
    for w in rows:
        w[0] = 2.0 * x[1]
    return np.sum(x ** 2)


def row_given_to_a_helper(a, x):
    rows = [a[k] for k in range(3)]
    scale(rows[1])
    return np.sum(a ** 2)


def written_after_it_was_appended(a, x):
    rows = []
    for k in range(3):
        w = np.zeros(2)
        rows.append(w)
        w[0] = x[k]
    return np.sum(np.array(rows) ** 2)


def written_under_another_name(a, x):
    rows = []
    v = np.ones(2)
    for k in range(3):
        w = np.zeros(2)
        v[1] = x[0]
        w[0] = x[k]
        v = w
        rows.append(w)
    return np.sum(np.array(rows) ** 2)


def written_after_a_branch(a, x):
    rows = []
    for k in range(3):
        w = np.zeros(2)
        if k > 0:
            rows.append(w)
        w[0] = x[k]
    return np.sum(np.array(rows) ** 2)


def appended_again_and_again(a, x):
    rows = []
    for k in range(3):
        w = np.zeros(2)
        for j in range(2):
            w[j] = x[k]
            rows.append(w)
    return np.sum(np.array(rows) ** 2)


def one_array_always(a, x):
    rows = []
    w = np.zeros(2)
    for k in range(3):
        w[0] += x[k]
        rows.append(w)
    return np.sum(np.array(rows) ** 2)


def shown_by_a_function(a, x):
    rows = []
    for _ in range(2):
        rows.append(np.asarray(x))
    x[0] = 2.0 * x[1]
    return np.sum(np.array(rows) ** 2)


def cases():
    a, x = np.array([[0.9, 0.31, 1.4], [0.55, 1.13, 0.7], [0.2, 0.4, 1.7]]), np.array([0.7, 1.2, 0.4])
    # arrays that are new in every turn
    yield Case(new_in_every_turn, (a, x), ("a", "x"))
    # rows of an array in a list are views
    yield Case(row_given_to_a_helper, (a, np.ones(3)), ("a",), ("return", "a"))
    for kernel in (
            written_after_it_was_appended, written_under_another_name, written_after_a_branch,
            appended_again_and_again, one_array_always, row_of_the_list_written):
        yield Case(kernel, (np.ones((3, 3)), np.ones(3)), "x")
    for kernel in (shown_by_a_function, rows_written_in_a_loop):
        yield Case(kernel, (np.ones((3, 3)), np.ones(3)), "x", of=("x", "return"))
    # what would show
