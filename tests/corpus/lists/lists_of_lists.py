"""Lists of lists that grow: nested comprehensions, and rows that a loop fills and appends."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])
HELD = "a list holds another list that is written, not a copy of it: append a copy: .append(list(w))"


def distances(x, y):
    cost = np.array([[(a - b) ** 2 for b in y] for a in x])
    ends = np.array([[abs(a - y[j]) for j in range(len(y))] for a in x])
    return np.sum(cost * ends) + cost[1, 0]


def filled(x):
    n = len(x)
    table = []
    for a in x:
        row = []
        for b in x:
            row.append(a * b ** 2)
        table.append(row)
    total = 0.0
    for row in table:
        total += sum(row) * len(row)
    return total + table[1][2] * table[-1][0] + np.sum(np.array(table)[:, n - 1])


def written(x):
    table = [[0.0 for _ in range(len(x))] for _ in range(len(x))]
    for i in range(len(x)):
        for j in range(len(x)):
            table[i][j] = x[i] * x[j] ** 2
    total = 0.0
    for i in range(len(x)):
        table[i][i] += table[i][i - 1]
        total += table[i][i] * table[0][i]
    return total


def cubes(x):
    n = len(x)
    t = [[[x[i] * x[j] * x[k] ** 2 for k in range(n)] for j in range(n - 1)] for i in range(n)]
    return np.sum(np.array(t) ** 2) + t[1][2][0]


def products(x):
    n = len(x)
    a = [[x[i] * x[j] + 1.0 for j in range(n)] for i in range(n)]
    c = [[sum(a[i][k] * a[k][j] for k in range(n)) for j in range(n)] for i in range(n)]
    return sum(sum(row) for row in c) + max(max(row) for row in a)


def joined(x):
    rows = [[v * x[k] for v in x] for k in range(len(x))]
    both = rows[0] + rows[1]
    return both[1] * both[5] * len(both)


def regrown(x):
    table = []
    for a in x:
        row = []
        for b in x:
            row.append(a - b)
        table.append(row)
        row.append(a)
    return np.sum(np.array(table) ** 2)


def written_behind(x):
    table = []
    for a in x:
        row = []
        for b in x:
            row.append(a - b)
        table.append(row)
        row[0] = 7.0 * a
    return np.sum(np.array(table) ** 2)


def written_before(x):
    table, k = [], 0
    while k < 3:
        row = []
        for b in x:
            row.append(x[k] - b)
        if k > 0:
            table.append(row)
        k += 1
    return np.sum(np.array(table) ** 2)


def several_times(x):
    table, row = [], []
    for b in x:
        row.append(b ** 2)
    for _ in x:
        table.append(row)
    table[0][0] = 5.0 * x[0]
    return np.sum(np.array(table) ** 2)


def in_two_lists(x):
    one, other = [], []
    for a in x:
        row = []
        for b in x:
            row.append(a - b)
        one.append(row)
        other.append(row)
    one[0][0] = 5.0 * x[0]
    return other[0][0] + np.sum(np.array(one))


def triangular(x):
    rows = [[x[i] - x[j] for j in range(i + 1)] for i in range(len(x))]
    return rows[2][1] * rows[3][0]


def cases():
    yield Case(distances, (X, X[1:] * 1.3), ("x", "y"))
    for kernel in (filled, written, cubes, products, joined, written_before):
        yield Case(kernel, (X,), "x")
    for kernel in (regrown, written_behind, several_times):
        yield Case(kernel, (X,), "x", refused=f"S201 at `table.append(row)`: {HELD}")
    yield Case(in_two_lists, (X,), "x", refused=f"S201 at `one.append(row)`: {HELD}")
    yield Case(triangular, (X,), "x", refused=(
        "S201 at `[[x[i] - x[j] for j in range(i + 1)] for i in range(len(x))]`: the sizes of the rows of 'rows' "
        "are not known where the list is made: allocate an array before and fill it in a for loop"))
