"""Lists of views: what is written through the list is written in the array and the other way round, or refused."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

A = np.array([[0.3, 0.4], [0.5, 0.6], [0.8, 0.2], [0.7, 0.9]])


def scale(r, by):
    r *= by


def through_the_list(a):
    rows = [a[i] for i in range(2)]
    for r in rows:
        r *= 2.0  # noqa: PLW2901
    rows[1][0] = a[3, 1] * rows[0][1]
    return np.sum(a ** 2)


def through_a_function(a):
    b = a * a
    rows = []
    for i in range(1, 4):
        rows.append(b[i])
    for r in rows:
        scale(r, a[0, 0])
    for i in range(1, 3):
        rows[i][:] -= rows[i - 1] * a[0, 1]
    return np.sum(b ** 2) + rows[-1][0] * len(rows)


def through_the_array(a):
    n = len(a)
    b = a.copy()
    rows, shifted = [b[i, :] for i in range(n)], []
    for i in range(n - 1):
        shifted.append(b[i + 1])
    b[1] = 3.0 * a[0]
    s = rows[1][0] * shifted[0][1]
    shifted[0][0] *= s
    return rows[1] @ b[1] + s * np.array(rows)[1, 0]


def of_its_own(a):
    """New arrays in a list are no views; what is not read again would not tell."""
    kept, fresh = [], []
    h = np.ones(2)
    for i in range(3):
        h = np.sin(h * a[i])
        kept.append(h)
        fresh.append(a[i].copy())
    b, last = a * 2.0, []
    for i in range(3):
        last.append(b[i])
    for r in fresh:
        r *= 3.0  # noqa: PLW2901
    fresh[1][0] = a[0, 0]
    last[0][:] = a[1]
    return np.sum(np.array(kept) ** 2) * fresh[0] @ fresh[1] + np.sum(np.array(last) * 2.0)


def in_each_iteration(a, u):
    s = 0.0
    for k in range(2):
        b = u * (k + 1.0)
        rows = [b[i] for i in range(2)]
        rows[1][0] *= a[k, 0]
        s += np.sum(b * rows[0]) + rows[1][1]
    return s


def of_named_rows(a):
    rows, last = [], [r for r in a[2:]]
    for i in range(2):
        r = a[i]
        rows.append(r)
    rows[1][0] = 3.0
    x, y = last[0], last[1]
    x += y * rows[0][1]
    return np.sum(a ** 2)


KERNELS = [(k, (A,)) for k in (of_named_rows, through_the_list, through_a_function, through_the_array, of_its_own)]
KERNELS += [(in_each_iteration, (A, A[:2].copy()))]


def of_one_array(a):
    rows = []
    for _ in range(2):
        rows.append(a)
    rows[0][0, 0] = 5.0
    return a[0, 0] ** 2


def one_array_several_times(a):
    b = a * 2.0
    rows = [b for _ in range(3)]
    rows[0][0, 0] = 7.0
    return rows[1][0, 0] * a[0, 0]


def of_columns(a):
    columns = [a[:, j] for j in range(2)]
    for c in columns:
        scale(c, 2.0)
    return a[2, 1] * a[1, 1]


def twice_the_same_rows(a):
    rows = [a[i // 2] for i in range(4)]
    rows[0][0] = 2.0
    return rows[1][0] * a[0, 0]


def two_lists(a):
    b = a * 2.0
    rows, ends = [b[i] for i in range(3)], [b[-1] for _ in range(2)]
    rows[2][0] = 3.0
    return np.sum(b) * ends[0][0]


def of_two_names(a):
    b = a[0] * 2.0
    rows = [b]
    for i in range(2):
        c = b * a[i]
        rows.append(c)
    rows[0][0] = 2.0
    return b[0] * c[1]


def cases():
    # gradients
    for kernel, arguments in KERNELS:
        yield Case(kernel, arguments, ("a", "u")[:len(arguments)])
    for kernel in (of_one_array, of_columns, twice_the_same_rows):
        yield Case(kernel, (A,), "a", of=("a", "return"))
    for kernel in (one_array_several_times, two_lists, of_two_names):
        yield Case(kernel, (A,), "a")
    # refused
