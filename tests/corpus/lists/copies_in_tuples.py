"""Tuples and lists of arrays in lists: Python holds the arrays themselves, which copies must not show."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

A = np.array([[0.9, 0.31, 1.4], [0.55, 1.13, 0.7], [0.2, 0.4, 1.7], [0.8, 1.2, 0.6]])
X = np.array([0.7, 1.2, 0.4])


def scale(v):
    v *= 2.0


def step(u, v):
    u[0] = u[0] * v[1]
    return u, v


def written_after_it_was_appended(a, x):
    ts = []
    for k in range(2):
        ts.append((a[k], a[k + 1]))
    a[0, 0] = 9.0 * x[1]
    return ts[0][0][0] * x[2]


def written_in_every_turn(a, x):
    hist = []
    u, v = x * 1.0, x * 2.0
    for _ in range(3):
        u[0] = u[0] * x[1]
        hist.append((u, v))
    return np.sum(hist[0][0] ** 2) + np.sum(hist[2][1])


def an_argument_in_a_comprehension(a, x):
    hist = [(x * k, x) for k in range(3)]
    x *= 2.0
    return np.sum(hist[1][1] ** 2) + np.sum(hist[2][0])


def lists_in_a_comprehension(a, x):
    ts = [[a[k], x] for k in range(3)]
    a[0, 0] = 5.0 * x[1]
    return np.sum(ts[0][0] ** 2)


def put_into_a_list_of_none(a, x):
    ts = [None] * 3
    for k in range(3):
        ts[k] = [x, x * 2.0]
    x[0] = 9.0 * a[0, 0]
    return np.sum(ts[1][0] ** 2)


def tuples_with_names(a, x):
    ts = []
    u, v = x * 2.0, x * 3.0
    ts.append((v, u))
    for _ in range(2):
        t = (u, v)
        ts.append(t)
        u[0] = 3.0 * x[1]
    return np.sum(ts[1][0] ** 2)


def returned_by_a_helper(a, x):
    u, v = x * 2.0, x * 3.0
    ts = []
    ts.append((v, u))
    for _ in range(3):
        ts.append(step(u, v))
    return np.sum(ts[1][0] ** 2)


def rows_of_a_matrix_in_a_loop(a, x):
    ts = [(a[k], a[k + 1]) for k in range(2)]
    for u, _ in ts:
        u[0] *= 2.0
    return np.sum(a ** 2)


def names_in_a_loop(a, x):
    u, v = x * 2.0, x * 3.0
    ts = []
    ts.append((u, v))
    for p, q in ts:
        p[0] += q[1]
    return np.sum(u * v)


def an_element_of_an_item(a, x):
    ts = [[a[k], x] for k in range(3)]
    ts[1][0][0] = 5.0 * x[1]
    return np.sum(a ** 2)


def one_array_in_every_row(a, x):
    u, ts = x * 2.0, []
    for k in range(2):
        ts.append((u, a[k]))
    t = ts[1]
    t[0][0] = 3.0 * x[1]
    return np.sum(ts[0][0])


def tuples_in_tuples(a, x):
    u, ts = x * 2.0, []
    for k in range(2):
        ts.append(((u, a[k]), (x, u)))
    (p, _), _ = ts[1]
    p[0] = 3.0 * x[1]
    return np.sum(u ** 2)


def an_item_given_to_a_helper(a, x):
    u, ts = x * 2.0, []
    ts.append((u, x))
    scale(ts[0][0])
    return np.sum(u ** 2)


def another_item_while_a_name_stands_for_it(a, x):
    ts = [[x, x * 2.0] for _ in range(3)]
    p = ts[0][0]
    ts[0][0] = x * 3.0
    return np.sum(ts[0][0] * ts[1][0]) + np.sum(p ** 2)


def what_does_not_show(a, x):
    u, first, second, third, fourth = np.zeros(3), [], [], [], []
    for j in range(3):
        u[j] = x[j] * 2.0
    for k in range(3):
        first.append((u, a[k]))
    for k in range(3):
        w = np.zeros(2)
        w[0] = x[k]
        second.append((w, x[:2] * k))
        third.append(np.array([x, u]))
        fourth.append((a[k] * 2.0, x * k))
    for p, q in fourth:
        p[0] = q[1] * 2.0
    for p, q in second:
        p[1] += q[1]
    rows = [[x, x * 2.0] for _ in range(3)]
    rows[0][0] = x * 3.0
    s = np.sum(rows[0][0] * rows[1][0]) + np.sum(third[1])
    third[1][0][0] = 2.0
    s += np.sum(third[1][0] ** 2) + second[1][0][1] * fourth[1][0][0]
    for p, q in first:
        s += np.sum(p * q)
    return s


def written_list(a, x):
    h = [[x[0], x[1]]]
    w = [x[1], x[2]]
    h.append(w)
    w[0] = 9.0 * a[0, 0]
    return h[1][0] * h[0][0]


def written_list_in_every_turn(a, x):
    w = [x[1], x[2]]
    h = [[x[0], x[1]]]
    for _ in range(3):
        w[0] = w[0] * 2.0
        h.append(w)
    return h[0][0] * h[1][1]


def written_row(a, x):
    w = [x[1], x[2]]
    h = [[x[0], x[1]]]
    h.append(w)
    h[1][0] = 9.0 * a[0, 0]
    return w[0] * w[1]


def written_row_in_a_loop(a, x):
    w = [x[1], x[2]]
    h = [[x[0], x[1]]]
    h.append(w)
    for r in h:
        r[0] = 9.0 * a[0, 0]
    return w[0] * w[1]


def new_lists(a, x):
    h, y = [[x[0], x[1]]], np.zeros((2, 2))
    for k in range(3):
        w = [x[1], x[2]]
        w[0] = w[0] * x[k]
        h.append(w)
    w = [x[2], 2.0]
    y[0] = w
    w[0] = 3.0 * x[0]
    h[1][0] *= 2.0
    return h[0][0] * h[1][1] * h[2][0] * w[0] + np.sum(y) * h[1][0]


def integers_beside_floats(a, x):
    s = 0.0
    ts = [(x[k], k) for k in range(3)]
    for v, k in ts:
        s += v * x[k]
    return s


def written_before_a_list_of_lists_is_read(a, x):
    ts = [[a[0], a[1]], [a[2], a[3]]]
    a[0, 0] = 9.0 * x[1]
    return ts[0][0][0] * x[2]


def cases():
    for kernel in (written_after_it_was_appended, lists_in_a_comprehension):
        yield Case(kernel, (A, X), "x", of=("a", "return"))
    for kernel in (written_in_every_turn, tuples_with_names, returned_by_a_helper):
        yield Case(kernel, (A, X), "x")
    for kernel in (an_argument_in_a_comprehension, put_into_a_list_of_none):
        yield Case(kernel, (A, X), "x", of=("x", "return"))
    # arrays that are written show in what holds them
    for kernel in (rows_of_a_matrix_in_a_loop, an_element_of_an_item):
        yield Case(kernel, (A, X), "x", of=("a", "return"))
    for kernel in (
            names_in_a_loop, one_array_in_every_row, tuples_in_tuples, an_item_given_to_a_helper,
            another_item_while_a_name_stands_for_it):
        yield Case(kernel, (A, X), "x")
    # what does not show
    yield Case(what_does_not_show, (A, X), ("a", "x"))
    for kernel in (written_list, written_list_in_every_turn, written_row, written_row_in_a_loop):
        yield Case(kernel, (A, X), "x")
    # new lists
    yield Case(new_lists, (A, X), ("a", "x"))
    # an integer beside a float is a float and picks nothing
    yield Case(integers_beside_floats, (A, X), "x")
    # rows that are spelled out
    yield Case(written_before_a_list_of_lists_is_read, (A, X), ("a", "x"), ("return", "a"))
