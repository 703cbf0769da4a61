"""Kernels whose choices leave what is infinite or nan, with the derivative by each element: of what is taken alone."""
# ruff: noqa: PLR0124
from __future__ import annotations

import numpy as np

FROM_ZERO = np.array([0.0, 1.0, 2.0])
NEGATIVE = np.array([-1.0, 1.0, 2.0])
WITH_NAN = np.array([1.0, np.nan, 3.0])
OVERFLOWING = np.array([-800.0, 0.0, 1.0])
LOG = np.log(2.0)
ROOT = np.sqrt(2.0)


def entropy_by_statements(x):
    logs = np.log(x)
    y = x * logs
    z = np.where(x > 0.0, y, 0.0)
    return np.sum(z)


def entropy_in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        y = x[i] * np.log(x[i])
        s += y if x[i] > 0.0 else 0.0
    return s


def branch_behind(x):
    y = x * np.log(x)
    s = 0.0
    for i in range(x.size):
        if x[i] > 0.0:
            s += y[i]
    return s


def mask_behind(x):
    y = x * np.log(x)
    return np.sum(y[x > 0.0])


def part_behind(x):
    y = x * np.log(x)
    return np.sum(y[1:])


def mask_overwrites(x):
    y = x * np.log(x)
    y[x <= 0.0] = 0.0
    return np.sum(y)


def mask_copies(x):
    y = x * np.log(x)
    z = np.zeros_like(x)
    m = x > 0.0
    z[m] = y[m]
    return np.sum(z)


def sum_where(x):
    y = x * np.log(x)
    return np.sum(y, where=x > 0.0)


def nested_choices(x):
    return np.sum(np.where(x > 0.0, np.where(x > 0.5, x * np.log(x), x / x), 0.0))


def x_log_x(v):
    return v * np.log(v)


def inlined_helper(x):
    y = x_log_x(x)
    return np.sum(np.where(x > 0.0, y, 0.0))


def logarithm(v):
    return np.log(v)


def helper(x):
    s = 0.0
    for i in range(x.size):
        part = logarithm(x[i])
        y = x[i] * part
        if x[i] > 0.0:
            s += y
    return s


def copyto(x):
    y = x * np.log(x)
    np.copyto(y, 0.0, where=x <= 0.0)
    return np.sum(y)


def select(x):
    return np.sum(np.select([x > 0.0], [x * np.log(x)], 0.0))


def nansum(x):
    return np.nansum(x * x)


def nanmean(x):
    return np.nanmean(x * x) * 2.0


def not_nan(x):
    y = x * x
    return np.sum(y[~np.isnan(y)])


def branch_on_nan(x):
    s = 0.0
    for i in range(x.size):
        if not np.isnan(x[i]):
            s += x[i] * x[i]
    return s


def compared_with_itself(x):
    s = 0.0
    for i in range(x.size):
        y = x[i] * x[i]
        if y == y:
            s += y
    return s


def fmax(x):
    return np.sum(np.fmax(x * x, 0.0))


def where_equal(x):
    return np.sum(np.where(x == x, x * x, 0.0))


def nanmax(x):
    return np.nanmax(x * x)


def finite_only(x):
    m = np.isfinite(x)
    return np.sum((x * x)[m])


def roots_of_negatives(x):
    return np.sum(np.maximum(np.where(x > 0.0, np.sqrt(x) * x, 0.0), 0.0))


def double_where(x):
    return np.sum(np.where(x > 0.0, x / np.where(x>0.0,x,0.0) * x, 0.0))


def sinc(x):
    return np.sum(np.where(x != 0.0, np.sin(x) / x * x, x))


def zero_divisor(x):
    c = np.array([0.0, 1.0, 2.0])
    w = x / c
    return np.sum(np.where(c > 0.0, w * x, 0.0))


def clipped(x):
    return np.sum(np.clip(np.where(x > 0, x * np.log(x), 0.0), -10.0, 10.0))


def absolute(x):
    return np.sum(np.abs(np.where(x > 0, x * np.log(x), 0.0)))


def greatest(x):
    return np.max(np.where(x > 0, x * np.log(x), 0.0))


def negative_power(x):
    return np.sum(np.where(x > 0, x ** -0.5 * x, 0.0))


def power_of_itself(x):
    return np.sum(np.where(x > 0, x ** x, 0.0))


def logistic(x):
    return np.sum(1.0 / (1.0 + np.exp(-x)))


def logistic_by_statements(x):
    e = np.exp(-x)
    b = 1.0 + e
    y = 1.0 / b
    return np.sum(y)


def logistic_in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        e = np.exp(-x[i])
        s += 1.0 / (1.0 + e)
    return s


def exponential(v):
    return np.exp(-v)


def logistic_of_helper(x):
    e = exponential(x)
    return np.sum(1.0 / (1.0 + e))


def inverse(e):
    return 1.0 / (1.0 + e)


def logistic_in_helper(x):
    s = 0.0
    for i in range(x.size):
        s += inverse(np.exp(-x[i]))
    return s


def logistic_as_power(x):
    return np.sum((1.0 + np.exp(-x)) ** -1)


CASES = [
    *((f, FROM_ZERO, [0.0, 1.0, 1.0 + LOG]) for f in (entropy_by_statements, entropy_in_a_loop, branch_behind,
      mask_behind, part_behind, mask_overwrites, mask_copies, sum_where, nested_choices, inlined_helper, helper,
      copyto, select, clipped)),
    *((f, FROM_ZERO, [0.0, 0.0, 1.0 + LOG]) for f in (absolute, greatest)),
    *((f, FROM_ZERO, [0.0, 2.0, 2.0]) for f in (zero_divisor,)),
    *((f, FROM_ZERO, [1.0, np.cos(1.0), np.cos(2.0)]) for f in (sinc,)),
    *((f, FROM_ZERO, [0.0, 0.5, 0.5 / ROOT]) for f in (negative_power,)),
    *((f, NEGATIVE, [0.0, 1.5, 1.5 * ROOT]) for f in (roots_of_negatives,)),
    *((f, NEGATIVE, [0.0, 1.0, 1.0]) for f in (double_where,)),
    *((f, NEGATIVE, [0.0, 1.0, 4.0 + 4.0 * LOG]) for f in (power_of_itself,)),
    *((f, WITH_NAN, [2.0, 0.0, 6.0]) for f in (nansum, nanmean, not_nan, branch_on_nan, compared_with_itself, fmax,
      where_equal, finite_only)),
    *((f, WITH_NAN, [0.0, 0.0, 6.0]) for f in (nanmax,)),
    *((f, OVERFLOWING, [0.0, 0.25, np.e / (1.0 + np.e) ** 2]) for f in (logistic, logistic_by_statements,
      logistic_in_a_loop, logistic_of_helper, logistic_in_helper, logistic_as_power)),
]
