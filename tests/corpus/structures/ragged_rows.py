"""Lists in a list that are filled each apart, `rows[i].append(v)`: the list that holds them has a known length."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([1.1, 2.2, 0.3, 1.7])


def neighbours(x, reference, n):
    near = [[] for _ in range(n)]
    for i in range(n):
        for j in range(i + 1, n):
            if abs(reference[i] - reference[j]) < 1.5:
                near[i].append(j)
    return sum((x[i] - x[j]) ** 2 for i in range(n) for j in near[i])


def pairs(x, n):
    near = [[] for _ in range(n)]
    for i in range(n):
        for j in range(n):
            if i != j and abs(x[i] - x[j]) < 1.0:
                near[i].append((j, x[j] ** 2))
    u = x.copy()
    for _ in range(2):
        v = u.copy()
        for i in range(n):
            for j, w in near[i]:
                v[i] += 0.1 * w * (u[j] - u[i])
        u = v
    return np.sum(u ** 2)


def in_turns(x, n):
    rows = [[] for _ in range(2)]
    first = rows[0]
    for i in range(n):
        if x[i] > 1.0:
            first.append(x[i])
        rows[i % 2].append(x[i] ** 2)
    return sum(rows[0]) * sum(rows[1])


def one_list_twice(x, n):
    rows = [[]] * 2
    for i in range(n):
        rows[i % 2].append(x[i] ** 2)
    cells = [[] for _ in range(n)]
    cells[0].append(x[0])
    cells[1] = cells[0]
    for i in range(n):
        if x[i] > 1.0:
            cells[i].append(x[i] ** 2)
    return sum(rows[0]) * len(rows[1]) + sum(cells[0]) * sum(cells[1]) + len(cells[1])


def triangle(x, n):
    table = [[] for _ in range(n)]
    for i in range(n):
        for k in range(i + 1):
            table[i].append(x[k] * (table[i - 1][k - 1] if i > 0 and k > 0 else 1.0))
    return sum(table[n - 1]) + table[2][1]


def where_the_run_says(x, n):
    cells = [[] for _ in range(3)]
    for i in range(n):
        cells[int(x[i])].append(i)
    return sum(x[i] * x[j] for c in cells for i in c for j in c)


def as_many_as_the_run_says(x):
    k = int(x[1])
    cells = [[] for _ in range(k)]
    for i in range(k):
        cells[i].append(x[i])
    return sum(cells[0])


def cases():
    yield Case(neighbours, (X.copy(), np.arange(4.0), 4), ("x",))
    for kernel in (pairs, in_turns, one_list_twice, triangle):
        yield Case(kernel, (X.copy(), 4), ("x",))
    yield Case(where_the_run_says, (X.copy(), 4), ("x",), refused=(
        "S201 at `cells[int(x[i])]`: which item of 'cells' is meant must be known before the run: loop over a range "
        "that is known, or keep a table and counts: table[k, count[k]] = i; count[k] += 1"))
    yield Case(as_many_as_the_run_says, (X.copy(),), ("x",), refused=(
        "S201 at `cells[i].append(x[i])`: a list is appended to that is an item of a list whose length only the run "
        "knows: make the outer list of a length that is known before the run, or keep a table and counts: "
        "table[k, count[k]] = i; count[k] += 1"))
