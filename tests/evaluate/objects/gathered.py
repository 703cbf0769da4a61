"""Comprehensions over arrays, deques, histories, keys, sets, contexts and lists of indices beside objects."""
from __future__ import annotations

import enum
from collections import deque
from contextlib import contextmanager
from functools import partial

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 1.4, 0.7])
ENDS = np.array([[0, 1], [1, 2], [2, 3]])
STIFFNESS = np.array([[1.0, -1.0], [-1.0, 2.0]])


class Table:
    def __init__(self, x):
        self.x, self.k = x, 0

    def at(self, v):
        j = int(v)
        w = v - j
        return (1 - w) * self.x[j] + w * self.x[j + 1]


def values_of_a_comprehension(x):
    table = Table(x)
    places = np.linspace(0.1, 1.9, x.size + 3)
    return np.sum(np.array([table.at(v * x[1]) for v in places]) ** 2)


def sum_and_greatest_of_generators(x):
    table = Table(x)
    places = np.linspace(0.1, 1.9, x.size + 2)
    return sum(table.at(v) * v for v in places) + max(table.at(v) for v in places)


def filtered_list(x):
    log = {"c": [x[0] * 2, x[1], x[2] * x[3], x[3] ** 2]}
    over = [c for c in log["c"] if c > 0.65]
    return sum(over) * len(over) + sum(v * v for v in log["c"] if v > 1)


def filtered_items(x):
    table = Table(x)
    return sum(table.at(abs(v)) for v in x if v > 0.5)


def rows_beside_a_list(x):
    cs = [x * 2, x ** 2, np.sin(x)]
    s = 0.0
    for row in np.outer(x, x):
        s += sum(a * np.sum(c) for a, c in zip(row, cs)) * row[0]
    return s


def blocks_by_rows_of_indices(x):
    k = np.zeros((4, 4))
    for e in range(3):
        ends = ENDS[e]
        k[ends[:, None], ends[None, :]] += x[e] * STIFFNESS
    return np.sum(k * np.outer(x, x)) + k[2, 2]


def blocks_by_ix(x):
    k = np.zeros((4, 4))
    for e in range(3):
        k[np.ix_(ENDS[e], ENDS[e])] += x[e] * STIFFNESS
    free = np.array([1, 2])
    return np.sum(k * np.outer(x, x)) + np.sum(np.linalg.solve(k[np.ix_(free, free)], x[free]))


def last_of_a_deque(x):
    past = deque([x * 0.5, x], maxlen=3)
    u = x
    for _ in range(4):
        u = np.sin(u) + 0.3 * past[0] - 0.1 * past[-1]
        past.append(u)
    return sum(np.sum(p ** 2) for p in past) * len(past)


def deque_turned(x):
    d = deque([x[0], x[1] * x[2], x[3]])
    d.rotate(1)
    d.appendleft(d.pop() ** 2)
    return d[0] * 3 + d.popleft() * d[1]


def history_nobody_reads(x):
    history, u, t = [], x, 0.0
    while t < 0.7:
        dt = min(0.2, 0.7 - t)
        u = u + dt * np.sin(u)
        t += dt
        history.append(u.copy())
    return np.sum(u * u)


def history_of_which_one_is_read(x):
    history, u = [], x
    for _ in range(4):
        u = u + 0.2 * np.sin(u)
        history.append(u)
        u = u * 1.1
    return np.sum(u * history[2])


class Color(enum.Enum):
    RED = 1
    BLUE = 2


def odd_keys(given, c):
    return given[0.5] * c + given[True] ** 2 + given[1, "a"] * given[Color.RED] * given[Color.BLUE]


def members_of_a_set(given, c):
    return c ** 2 if 3 in given and 4 not in given else c


functions = [partial(np.power, 2.0), Table(X).at, abs]


def partials_and_methods(c):
    return sum(f(c) for f in functions)


lambdas = [lambda c: c * c, lambda c: c ** 3]


def lambdas_of_a_line(c):
    return lambdas[0](c) * lambdas[1](c)


@contextmanager
def scaled(x, by):
    x *= by
    try:
        yield x[0]
    finally:
        x /= by


def within_a_context(x):
    u = x.copy()
    with scaled(u, x[2]) as first, scaled(u, 2.0):
        s = first * np.sum(u ** 2)
    return s + np.sum(u)


def names_bound_in_a_comprehension(x):
    table = Table(x)
    low = sum((last := table.at(v)) ** 2 for v in np.linspace(0.1, 1.9, x.size))
    rows = [(first := v * x[0]) for v in x if (double := 2 * v) > 1]
    return low * last + first * len(rows) + double


def cases():
    for kernel in (values_of_a_comprehension, sum_and_greatest_of_generators, filtered_list, filtered_items,
                   rows_beside_a_list, blocks_by_rows_of_indices, blocks_by_ix, last_of_a_deque, deque_turned,
                   history_nobody_reads, history_of_which_one_is_read, within_a_context,
                   names_bound_in_a_comprehension):
        yield Case(kernel, (X,), "x")
    yield Case(odd_keys, ({0.5: 1.3, True: 0.7, (1, "a"): 2.0, Color.RED: 0.4, Color.BLUE: 1.5}, 0.8), "c")
    yield Case(members_of_a_set, ({3, 5}, 0.8), "c")
    yield Case(members_of_a_set, ({3, 4}, 0.8), "c")
    yield Case(partials_and_methods, (0.8,), "c")
    yield Case(lambdas_of_a_line, (0.8,), "c")
