"""Lists whose elements are written or that repeat one, places in lists that may count from the end, lists as places."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(5)
X, A = 0.2 + RNG.random(4), 0.2 + RNG.random((4, 2))


def of_numbers(x, n):
    v = [max(0.0, 3.0 - 2.0 * x[0] * j) for j in range(n + 1)]      # a tree that is folded in place
    for i in range(n - 1, -1, -1):
        for j in range(i + 1):
            v[j] = 0.5 * (v[j] + v[j + 1] ** 2)
    h = [1] * (n + 1)
    for i in range(n):
        h[i + 1] = h[i] * x[i]
        h[i % 3 - 1] += x[0] * h[-1]
    seen = [False for _ in range(n)]
    for k in (0, 2, 0):
        if not seen[k]:
            seen[k] = True
            h[0] += x[k]
    return v[0] * h[-1] + sum(h)


def of_arrays(a):
    p = 3
    d = [a[j] for j in range(p + 1)]        # de Boor's points
    for r in range(1, p + 1):
        for j in range(p, r - 1, -1):
            w = 0.1 * j + a[0, 0]
            d[j] = (1.0 - w) * d[j - 1] + w * d[j]
    sums = [np.zeros(2) for _ in range(2)]
    for t in range(3):
        for i in range(2):
            sums[i] += d[p] * a[t] ** 2 * (i + 1.0)
    return sums[0] @ sums[1]


def before_it_is_filled(a, n):
    b, s = a[:2] * 1.0, np.eye(2)
    gains = [None] * n
    stages = []
    for t in range(n - 1, -1, -1):
        k = np.linalg.solve(s + b.T @ s @ b, b.T @ s)
        s = s + 0.1 * k @ a[2:]
        gains[t] = k
    for t in range(n):
        y = a[t].copy()
        if t > 0:
            y += 0.5 * stages[t - 1]
        stages.append(np.sin(gains[t] @ y))
    return stages[-1] @ stages[0]


def tables(x, n):
    d = [[0.0] * (n + 1) for _ in range(n)]
    for i in range(1, n):
        for j in range(1, n + 1):
            d[i][j] = (x[i] - x[j - 1]) ** 2 + 0.3 * d[i - 1][j] + x[0] * d[i][j - 1]
    pairs = [(x[i], 1.0) for i in range(3)]
    pairs[1] = (x[0] * x[1], 2.0)
    k = n - 5
    u = pairs[0] + pairs[1] + pairs[k]
    return d[n - 1][n] + u[0] * u[2] * u[3] * u[4]


def named_places(x):
    f, k = np.zeros(5), np.outer(x, x)
    for e in range(4):
        both = [e, e + 1]
        f[both] += x[e]         # a list picks two elements
    rows, ends, one = [1, 2], [0, 3], (1, 2)
    y = k[rows] * 2.0
    z = k[ends, 1] + k[1:, ends][1]
    k[rows] *= 2.0
    k[ends, rows] += x[0]
    return f @ f + np.sum(y ** 2) + z[0] * z[1] + np.sum(k ** 2) + k[one]


KERNELS = [(named_places, (X,)), (of_numbers, (X, 4)), (of_arrays, (A,)),
           (before_it_is_filled, (A, 3)), (tables, (X, 3))]


def read_later(a):
    rows = [a[i] * 2.0 for i in range(4)]
    r = rows[0]
    rows[0] = rows[1] * 2.0
    return r @ rows[0]


def floats_among_integers(a):
    d = [[0] * 3 for _ in range(len(a))]
    d[1][2] = a[0, 0]
    return d[1][2] * d[0][0]


def longer(a):
    rows = [[a[i, 0], a[i, 1]] for i in range(3)]
    rows[0] += rows[1]
    return rows[0][0] * rows[0][1]


def put_into_another(a):
    rows = [a[i] for i in range(4)]
    rows[0] = a[1]
    rows[0][0] = 5.0
    return np.sum(a ** 2) * rows[1][0]


def beside_a_number_of_numpy(x):
    row = [x[0], x[1] * x[2]]
    return np.sum((row - x[3]) / np.max(row) * row[1])


def two_lists(x):
    row, other = [x[0], x[1]], [x[2], x[3]]
    return np.sum(row - other)


def times_a_float(x):
    pair = (x[0], x[1])
    return np.sum(0.5 * pair)


def less_a_written_number(x):
    row = [x[0], x[1]]
    row = np.array(row) - (row - 1.0)
    return np.sum(row)


def cases():
    # gradients
    yield Case(beside_a_number_of_numpy, (X,), "x")
    for kernel, arguments in KERNELS:
        yield Case(kernel, arguments, ("x" if arguments[0] is X else "a",))
    for kernel in (read_later, longer):
        yield Case(kernel, (A,), "a")
    yield Case(put_into_another, (A,), "a", of=("a", "return"))
    # refused
    yield Case(floats_among_integers, (A,), of=None, refused=(
        "S201 at `d[1][2] = a[0, 0]`: a float is put among the integers of a list that is an element of a "
        "list: start with floats: 0.0, not 0"))
    for kernel, marked, found in ((two_lists, "row - other", "list"), (times_a_float, "0.5 * pair", "tuple"),
                                  (less_a_written_number, "row - 1.0", "list")):
        yield Case(kernel, (X,), refused=(
            f"S201 at `{marked}`: Python has no such operator for a {found}: make it an array with np.array"))
