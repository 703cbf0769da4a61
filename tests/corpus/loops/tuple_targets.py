"""Tuples under one name, as loops and assignments of several names bind them: each item is a number or an array of its
own."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def up(v):
    v[0] *= 2.0
    return v[0]


def neighbours(x):
    s = 0.0
    for t in zip(x, x[1:]):
        s += t[0] * t[1]
    return s


def a_tuple_beside_a_number(x):
    w, b = x[0], (x[1], x[2])
    return w * b[0] + b[1]


def counted_and_written(x):
    s = 0.0
    for t in enumerate(x):
        s += t[0] * t[1]
        x[1] *= 2.0
        s += t[1]
        if t[0] == 1:
            continue
        s += t[-1] ** 2
    return s


def twice_under_one_name(x):
    s = 0.0
    for t in ((x[0], x[1]), (x[1], x[2])):
        x[1] *= 1.5
        s += t[0] * t[1]
    for t in zip(x[1:], x):
        a, b = t
        s += a * b
    return s


def summed(x):
    return sum(t[0] * t[1] for t in zip(x, x[1:])) + sum(t[1] for t in enumerate(x))


def tuples_beside_each_other(x):
    a, b = (x[0], x[1]), (x[1], x[2])
    x[1] = 5.0
    c, (d, e) = x[1], (x[0], x[2])
    return a[1] * b[0] + c * d * e


def rows(x):
    rows = [(x[0], x[1]), (x[1], x[2])]
    s = 0.0
    for r in rows:
        s += r[0] * r[1] * r[1]
    return s


def tuples_of_calls(x):
    a, b, c = (up(x), x[0]), x[0], (up(x), x[0], 1.0)
    return a[0] * a[1] + b * c[0] + c[1] * c[2]


def one_in_another(x):
    s = 0.0
    for i in range(2):
        for t in zip(x, x[1:]):
            for u in zip(x[1:], x):
                s += t[0] * u[1] * t[1]
        for t in zip(x, x[1:]):
            s += t[0] * i
    return s


def rows_that_are_written(x):
    rows = [(x[0], x[1]), (x[1], x[2])]
    s = 0.0
    for r in rows:
        rows[1] = (r[1] * 2.0, r[0])
        s += r[0] * r[1] * r[1]
    for r in rows:
        s += r[0]
    return s


def rows_of_an_array(x):
    a = np.outer(x, x)
    s = 0.0
    for t in zip(a, x):
        a[1, 0] = 3.0
        t[0][1] *= 2.0
        s += t[0][0] * t[0][1] * t[1]
    return s


def a_table(x):
    rows = ((0, 1, 0.5), (1, 2, 0.25), (0, 2, 2.0), (1, 1, 1.0), (2, 0, 3.0))
    s = 0.0
    for r in rows:
        s += r[2] * x[r[0]] * x[r[1]]
    return s


EVERY = (
    neighbours, a_tuple_beside_a_number, counted_and_written, twice_under_one_name, summed,
    tuples_beside_each_other, rows, tuples_of_calls, one_in_another, rows_that_are_written, rows_of_an_array,
    a_table)


def lists_in_tuples(x):
    us = [[x[0], x[1]], [x[1], x[2]]]
    vs = [x[1], x[2]]
    s = 0.0
    for t in zip(us, vs):
        us[1][0] *= 2.0
        us[0][1] *= 2.0
        vs[1] += 1.0
        s += t[0][0] * t[0][1] * t[1]
    return s


def read_after_the_loop(x):
    s = 0.0
    for t in zip(x, x[1:]):
        s += t[0] * t[1]
    return s * t[1]


def cases():
    # items are taken apart
    for kernel in EVERY:
        yield Case(kernel, [np.array([2.0, 3.0, 4.0])], ("x",))
    yield Case(lists_in_tuples, (np.array([2.0, 3.0, 4.0]),), "x")
    yield Case(read_after_the_loop, (np.array([2.0, 3.0, 4.0]),), "x")
