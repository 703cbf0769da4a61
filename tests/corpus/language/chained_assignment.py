"""A statement that assigns one value to several targets evaluates it once and stores it into each, whatever list the
first one is an element of; what then is one list or array under two names is refused where that would tell."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def up(v):
    v[0] *= 2.0
    return v[0]


def two_elements(x):
    ws = [x[k] * 1.0 for k in range(3)]
    ws[0] = ws[1] = x[2] * x[2]
    return ws[0] + 10.0 * ws[1]


def an_element_and_an_argument(x):
    ws = [x[k] * 1.0 for k in range(3)]
    ws[0] = x[0] = x[2] * x[2]
    return x[0] * ws[0]


def a_name_that_was_bound(x):
    ws = []
    for k in range(3):
        ws.append(x[k] * x[k])
    a = x[0]
    ws[0] = a = x[1] * 2.0
    ws[1] = ws[-1] = a = a * ws[2]
    return a * ws[0] + ws[1] * ws[2]


def an_item_of_a_dictionary(x):
    ws = [x[k] * 1.0 for k in range(3)]
    e = {"v": x[0]}
    ws[0] = e["v"] = x[1] * ws[2]
    return ws[0] + e["v"] * x[0]


def arrays(x):
    us = [x * (k + 1.0) for k in range(3)]
    us[0] = us[1] = x * x
    return us[0][0] + us[1][1] * us[2][2]


def rows(x):
    t = [[x[k], x[k] * x[0]] for k in range(3)]
    t[1] = t[0] = [x[1], x[2] * x[2]]
    return t[0][1] * t[1][0] + t[2][1] * t[1][1]


def tuples(x):
    t = [(x[k], x[k] * x[0]) for k in range(3)]
    t[1] = t[0] = (x[1], x[2] * x[2])
    return t[0][1] * t[1][0] + t[2][1] * t[1][1]


def an_index_that_is_bound(x):
    ws = [x[k] * 1.0 for k in range(3)]
    i = 0
    i = ws[i] = 1
    ws[i] = i = 2
    return ws[0] * x[0] + ws[1] * x[1] + ws[i] * x[i]


def in_a_loop(x):
    ws = [x[k] * 1.0 for k in range(3)]
    for k in range(2):
        if x[k] > 0.5:
            ws[k] = ws[k + 1] = x[k] = ws[k] * x[2] + x[k]
    return ws[0] + 2.0 * ws[1] * ws[2] + x[0] * x[1]


def one_array_twice(x):
    us = [x * 1.0, x * 2.0, x * 3.0]
    us[0] = us[1] = x * x
    us[0][1] = 5.0
    return us[0][0] + us[1][1] * us[2][2]


def elements_of_a_short_list(x):
    vs = [x[0], x[1], x[2]]
    vs[0] = vs[1] = x[2] * vs[0]
    vs[2] = a = vs[1] * vs[0]
    return a + vs[0] * vs[1] + vs[2] * x[1]


def parts_of_an_array(x):
    y = np.zeros((3, 3))
    y[0] = y[1] = x * x
    y[0, 1] = 3.0
    y[2, :] = y[:, 2] = y[0] * x
    return np.sum(y * y[1])


def of_a_call(x):
    ws = [x[k] * 1.0 for k in range(3)]
    ws[0] = ws[1] = x[1] = up(x) * x[0]
    return ws[0] + ws[1] * x[1] + x[0]


def of_a_sum(x):
    ws = [x[k] * 1.0 for k in range(3)]
    ws[0] = b = sum(v * v for v in ws)
    ws[1] = ws[2] = 3.0
    ws[1] = c = b
    return ws[0] * ws[2] + b * x[0] + ws[1] * c


def from_its_own_value(x):
    ws = [x[k] * 1.0 for k in range(3)]
    a = x[1]
    ws[0] = a = a * x[0]
    return a * ws[0]


def rows_written_before(x):
    r = [x[2], x[0] * x[0]]
    q = [x[1], x[0]]
    r[1] = x[2] * x[1]
    rows = [r, q]
    s = 0.0
    for a, b in rows:
        s += a * b
    return s * r[0]


RIGHT = (
    two_elements, an_element_and_an_argument, a_name_that_was_bound, an_item_of_a_dictionary, arrays, rows, tuples,
    an_index_that_is_bound, in_a_loop, one_array_twice, elements_of_a_short_list, parts_of_an_array, of_a_call,
    of_a_sum, from_its_own_value, rows_written_before)


def one_array_in_a_list_twice(x):
    us = [x * (k + 1.0) for k in range(3)]
    us[0] = us[1] = x * x
    us[0][1] = 5.0
    return us[0][0] + us[1][1] * us[2][2]


def an_array_with_a_name(x):
    us = [x * (k + 1.0) for k in range(3)]
    a = us[0] = x * x
    a[1] = 5.0
    return us[0][0] + us[0][1] * us[2][2]


def an_array_named_behind(x):
    us = [x * (k + 1.0) for k in range(3)]
    us[0] = a = x * x
    us[0][1] = 5.0
    return us[0][0] + a[1] * us[2][2]


def one_row_twice(x):
    t = [[x[k], x[k] * x[0]] for k in range(3)]
    t[1] = t[0] = [x[1], x[2] * x[2]]
    t[1][0] = x[0] * 7.0
    return t[0][1] * t[1][0] + t[2][1] * t[0][0]


def one_row_in_a_short_list(x):
    rows = [[x[0], x[1]], [x[1], x[2]]]
    rows[0] = rows[1] = [x[2], x[0] * x[0]]
    rows[0][1] = x[1]
    return rows[0][0] * rows[1][1] + rows[1][0]


def a_row_under_a_name(x):
    rows = [[x[0], x[1]], [x[1], x[2]]]
    r = [x[2], x[0] * x[0]]
    rows[0] = r
    rows[1] = r
    rows[0][1] = x[1]
    return rows[0][0] * rows[1][1] + rows[1][0]


def rows_of_a_round(x):
    s = 0.0
    for k in range(3):
        r = [x[k], x[0] * x[k]]
        rows = [r, [x[1], x[2]]]
        rows[0][1] *= 2.0
        s += rows[0][0] * rows[0][1]
    return s


def a_row_put_into_a_new_list(x):
    r = [x[2], x[0] * x[0]]
    rows = [r, [x[1], x[2]]]
    rows[0][1] = x[1] * x[1]
    return r[1] * rows[0][0]


def one_row_put_twice(x):
    r = [x[2], x[0] * x[0]]
    rows = [r, r]
    rows[0][1] = x[1] * x[1]
    return rows[1][1] * rows[0][0]


def a_row_written_behind(x):
    r = [x[2], x[0] * x[0]]
    rows = [r, [x[1], x[2]]]
    r[0] = 9.0 * x[1]
    return rows[0][0] * r[1]


def cases():
    # every target is assigned
    for kernel in RIGHT:
        given = [np.array([2.0, 3.0, 4.0])]
        changed = np.array(given[0])
        kernel(changed)
        of = ("return",) if np.array_equal(changed, given[0]) else ("x", "return")
        yield Case(kernel, given, ("x",), of)
    for kernel in (
            one_array_in_a_list_twice, an_array_with_a_name, an_array_named_behind, one_row_twice,
            one_row_in_a_short_list, a_row_under_a_name, a_row_put_into_a_new_list, rows_of_a_round,
            one_row_put_twice, a_row_written_behind):
        yield Case(kernel, (np.array([2.0, 3.0, 4.0]),), "x")
    # one list or array under two names is refused
