"""Tables of written numbers, of the kernel and of its module: rows that are picked, unpacked and gone through."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.9, 0.31, 1.4, 0.55, 1.13])
TERMS = ((0, 0.5), (1, 0.25), (4, 1.5))
POWERS = ((1, -1), (2, -2))
FLAGS = [[True, False], [False, True]]
MANY = [(k % 5, 0.1 * k) for k in range(40)]
PAIRS = tuple((k % 5, (3 * k + 1) % 5) for k in range(40))


def index_and_weight(x):
    terms = ((0, 0.5), (1, 0.25), (4, 1.5))
    total = 0.0
    for k in range(3):
        total += x[terms[k][0]] ** terms[k][1] + x[TERMS[k][0]] ** TERMS[k][-1]
        i, w = terms[k]
        j, v = TERMS[len(TERMS) - 1 - k]
        row = TERMS[k]
        total += x[i] * w * v * x[j] ** 2 + row[1] * x[row[0]]
    for i, w in terms:
        total += w * x[i] ** 2
    for k, (i, w) in enumerate(terms):
        total += w * x[i] * k
    for i, w in reversed(terms):
        total = total * w + x[i]
    for v, (i, w) in zip(x, terms):
        total += v * w * x[i]
    return total * len(terms) * len(terms[0])


def rows_of_a_helper(x, k):
    i, w = TERMS[k]
    return w * x[i]


def powers_and_flags(x):
    powers = ((1, -1), (2, -2))
    chosen = [[True, False], [False, True]]
    mixed = ((1, 0.5), (2, 0.25))
    total = 0.0
    for k in range(2):
        total += 2 ** powers[k][1] * x[0] + x[k] ** POWERS[k][1] * 2 ** POWERS[k][1]
        for j in range(2):
            total += mixed[j][k] * x[k]
            total += 2 ** powers[k][j] * x[j] + rows_of_a_helper(x, k)
            if chosen[k][j]:
                total += x[k] * x[j]
            if FLAGS[j][k]:
                total += x[k] * x[j] ** 2
        total += (FLAGS[k][0] + FLAGS[0][k]) * x[k]
    return total


def followed(x):
    after = ((2, 0.5), (0, 0.3), (1, 0.7))
    k, total = 0, 0.0
    for _ in range(5):
        k, w = after[k]
        total += w * x[k] ** 2
    return total


def more_than_are_written_out(x):
    total = sum(w * x[i] ** 2 for i, w in MANY)
    for k in range(len(MANY)):
        i, w = MANY[k]
        total += w * x[i] ** 2 + x[MANY[k][0]] ** MANY[k][1]
        i, j = PAIRS[k]
        total += x[i] * x[j] ** 2 + x[PAIRS[k][0]] * x[PAIRS[k][1]]
    for k, (i, w) in enumerate(MANY):
        total += w * x[i] ** 2 * k
    return total


def columns_by_a_variable(x):
    terms = ((0, 0.5), (1, 2))
    total = 0.0
    for k in range(2):
        for j in range(1):
            total += x[terms[k][j]]
    return total


class Neighbours:
    places = [0, 1, 0]

    def __init__(self, x):
        self.x = x

    def at(self, k):
        return self.x[self.places[k]]


def refused_beside_a_table(x):
    neighbours = Neighbours(x)
    total = 0.0
    for k in range(3):
        total += neighbours.at(k)
    return np.sum(np.partition(x, 1) * total)


def cases():
    # derivatives
    for kernel in (index_and_weight, powers_and_flags, more_than_are_written_out, followed, columns_by_a_variable):
        yield Case(kernel, (X,), ("x",))
    yield Case(refused_beside_a_table, (X,), refused="S301 at `np.partition(x, 1)`: no derivative rule for "
               "numpy.partition: write np.sort(x), whose order is determined")
