"""Kernels with roots where they are steep, with the derivative by each element."""
# ruff: noqa: PLR0124
from __future__ import annotations

import math

import numpy as np

from tests.differentiate.choices import FROM_ZERO, ROOT, WITH_NAN


def root_times(x):
    return np.sum(np.sqrt(x) * x)


def root_cubed(x):
    r = np.sqrt(x)
    return np.sum(r * r * r)


def root_in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        r = np.sqrt(x[i])
        s += r * r * r
    return s


def power_by_logarithm(x):
    return np.sum(np.exp(2.0 * np.log(x)))


def nan_stays(x):
    return np.sum(np.sqrt(x)*2.0)


def through_infinity(x):
    return np.sum(np.exp(-1.0 / x)) + np.tanh(2.0 / x[0])


def root_of_a_sum(x):
    return np.sqrt(np.sum(x * x)) + (x[0] ** 2 + x[1] ** 2) ** 0.5


def root_of_a_product(x):
    return np.sqrt(x @ x) + np.sqrt(np.dot(x, x) / 2.0)


def root_in_turns(x):
    s, t = 0.0, 1.0
    for i in range(x.size):
        s += 0.5 * x[i] ** 2 + abs(x[i]) * x[i] ** 4
        t += x[i] * x[i]
    return math.sqrt(s) + math.sqrt(s / t) - math.sqrt(t)


def length(d):
    return np.sqrt(np.sum(d * d))


def root_of_helper(x):
    return length(x - x[0]) + length(2.0 * x)


def deviation(x):
    return np.sqrt(np.mean((x - np.mean(x)) ** 2)) + np.std(x) + np.linalg.norm(x)


def distances(x):
    d = x[:, None] - x[None, :]
    lengths = np.sqrt(np.sum(d[:, :, None] ** 2, axis=2))
    return np.sum(lengths) + np.sum(np.where(lengths > 0.0, lengths, 0.0))


def stored_squares(x):
    squares = np.zeros(x.size)
    for i in range(x.size):
        for j in range(x.size):
            squares[i] += (x[i] - x[j]) ** 2
    return np.sum(np.sqrt(squares))


def roots_of_nothing(x):
    return np.sum(np.sqrt(np.sqrt(x * x) + np.hypot(x, x)) ** 2 + np.abs(x) ** 0.5 + np.maximum(x * x, x ** 4) ** 0.5)


def squares_overwritten_by_a_view(x):
    s = x * x
    v = s[1:]
    v[:] = x[1:]
    return np.sum(np.sqrt(s))


def square_rebound(x):
    s = x[0] * x[0]
    t = 0.0
    for i in range(x.size):
        t += np.sqrt(s)
        s = x[i]
    return t


def rows_of_squares(x):
    a = np.zeros((2, x.size))
    a[0] = x * x
    a[1] = x
    return np.sum(np.sqrt(a))


def factor_rebound(x):
    w = 2.0
    t = 0.0
    for i in range(x.size):
        t += np.sqrt(w * x[i] * x[i])
        w = x[i] + 1.0
    return t


def root_of(r2):
    return np.sqrt(r2)


def square_of(d):
    return d * d


def root_in_helper(x):
    t = 0.0
    for i in range(x.size):
        t += root_of(square_of(x[i]))
    return t


def steep_angles(x):
    return np.arcsin(1.0 - x[0] * x[0]) + np.arccos(1.0 - x[1] * x[2]) + np.arctan2(x[0] * x[0], x[2] * x[2])


def roots_of_products(x):
    return np.sum((x * x[::-1]) ** 0.3) + np.cbrt(x[0] * x[2] / (1.0 + x[1])) + np.sqrt(np.sin(x[0]) * np.sin(x[2]))


def weighted_root(x):
    w = np.array([0.0, 1.0, 2.0])
    return np.sqrt(np.sum(w * x))


def products_among_others(x):
    s = np.zeros(2)
    s[0] = x @ x
    s[1] = x[1]
    return np.sum(np.sqrt(s))


def unused(x):
    return np.sum(0.0 * np.sqrt(x) + x)


def root_behind_statements(x):
    v = x * x[::-1]
    w = v * (x - 1.0)
    r = np.sqrt(w)
    return np.sum(r)


def sum_of_roots(w):
    return np.sum(np.sqrt(w))


def roots_in_helper_behind_statements(x):
    """The infinite seed comes from the helper, which sets no flag here."""
    v = x * x[::-1]
    w = v * (x - 1.0)
    return sum_of_roots(w)


def root_in_later_turns(x):
    """Where the first turn is reversed last, a root has been infinite behind it."""
    y = np.zeros(3)
    s = 0.0
    for k in range(3):
        v = x * (x + k)
        y[:] = v * x
        if k > 0:
            s += np.sum(np.sqrt(y))
        y[:] = 1.0
    return s


def roots_on_one_side(x, mode=0):
    v = x * x[0]
    w = v * v[1]
    if mode > 0:
        return np.sum(np.sqrt(w + 1.0))
    return np.sum(np.sqrt(w))


ZEROS = (np.zeros(3), [0.0, 0.0, 0.0])
CASES = [
    *((f, np.array([0.0, 1.0, 0.0]), [0.0, np.inf, 0.0]) for f in (root_behind_statements,
      roots_in_helper_behind_statements)),
    (root_in_later_turns, np.zeros(3), [0.0, 0.0, 0.0]),
    (roots_on_one_side, *ZEROS),
    (unused, FROM_ZERO, [1.0, 1.0, 1.0]),
    (squares_overwritten_by_a_view, np.array([0.0, 1.0, 0.0]), [0.0, 0.5, np.inf]),
    (square_rebound, np.array([0.0, 4.0, 1.0]), [np.inf, 0.25, 0.0]),
    (rows_of_squares, np.array([0.0, 1.0, 4.0]), [np.inf, 1.5, 1.25]),
    (factor_rebound, np.array([0.0, 1.0, 0.0]), [0.5, 1.0, 0.0]),
    (products_among_others, np.zeros(3), [0.0, np.inf, 0.0]),
    (weighted_root, np.zeros(3), [0.0, np.inf, np.inf]),
    *((f, *ZEROS) for f in (root_in_helper, steep_angles, roots_of_products)),
    *((f, *ZEROS) for f in (root_of_a_sum, root_of_a_product, root_in_turns, root_of_helper, deviation, distances,
      stored_squares, roots_of_nothing)),
    (through_infinity, FROM_ZERO, [0.0, np.exp(-1.0), np.exp(-0.5) / 4.0]),
    *((f, FROM_ZERO, [0.0, 1.5, 1.5 * ROOT]) for f in (root_times, root_cubed, root_in_a_loop)),
    *((f, FROM_ZERO, [0.0, 2.0, 4.0]) for f in (power_by_logarithm,)),
    *((f, WITH_NAN, [1.0, np.nan, 1.0 / np.sqrt(3.0)]) for f in (nan_stays,)),
]
