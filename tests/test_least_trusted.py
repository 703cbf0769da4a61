"""Kernels written against the passes that are trusted least: loops run again, loops without order, stores that are
undone, records that are shared, gains that are joined."""
from __future__ import annotations

import math

import numpy as np
import pytest

from tests.derivatives import check_derivatives
from tests.engines import each


def double_write(x, y):
    # undone: a store overwritten, with an index that is rebound and a read hidden in another index
    k = 0
    for i in range(x.size - 1):
        x[k] = x[i] * y[i]
        k = (k + 1) % x.size
        x[k] = x[k] * x[k - 1] + y[k]
        x[k] = math.sin(x[k])


def rerun_left_over(x, y, work):
    total = 0.0
    for i in range(x.size):
        for k in range(work.size):
            work[k] = x[i] * y[k]
        for k in range(1, work.size):
            work[k] = work[k] * work[k - 1]
        total += work[work.size - 1] ** 2
    return total + work[0] ** 2


def free_order(x, y, idx):
    # sums through an index array beside a store by counter
    for i in range(x.size):
        y[idx[i]] += x[i] * x[i]
    for i in range(x.size):
        x[i] = x[i] * y[i]
        y[i] = y[i] * y[i]


def work_both_branches(x):
    w = np.zeros(3)
    total = 0.0
    for i in range(x.size):
        if x[i] > 0.8:
            for k in range(3):
                w[k] = x[i] * (k + 1.0)
        else:
            for k in range(3):
                w[k] += x[i] * x[i]
        for k in range(3):
            total += w[k] ** 3 * x[k]
    return total


def alloc_like_chain(x):
    total = 0.0
    for i in range(x.size):
        a = np.zeros(3)
        b = a + x[i]
        c = b * b
        a[1] += x[i] ** 2
        for k in range(3):
            total += a[k] * c[k] * b[k]
    return total


def helper_fill(w, v):
    for k in range(w.size):
        w[k] = v * (k + 1.0)


def helper_sum(w):
    s = 0.0
    for k in range(w.size):
        s += w[k] * w[k]
    w[0] = s
    return s


def rerun_by_helpers(x):
    w = np.empty(4)
    total = 0.0
    for i in range(x.size):
        helper_fill(w, x[i])
        total += helper_sum(w) * w[0]
    return total


def conditional_helper(x):
    w = np.ones(4)
    total = 0.0
    for i in range(x.size):
        if i % 2 == 0:
            helper_fill(w, x[i])
        total += helper_sum(w) * x[i]
        w[0] = w[1] * x[0]
    return total


def choice(x):
    best = x[0]
    at = 0
    s = 0.0
    for i in range(x.size):
        if x[i] > best:
            best = x[i]
            at = i
        s += best * x[at]
        if s > 1.5:
            s -= x[i]
        else:
            s += 0.5 * x[i] * s
    return s * best


def gain_order(x, y):
    for i in range(1, x.size):
        y[i] = x[i] * x[i - 1] + x[i] * y[i]
        y[i - 1] += x[i] * y[i] + x[i - 1] * y[i]
        y[i] = y[i] * x[i]


def shifted_twice(u, c):
    a = u[0]
    b = u[1]
    for i in range(u.size):
        here = u[i]
        u[i] = here * a - c * b * math.cos(here - a)
        b = a
        a = here


CASES = [
    (double_write, ((5,), (5,)), ("x", "y"), ("x",)),
    (rerun_left_over, ((4,), (3,), (3,)), ("x", "y", "work"), ("return", "work")),
    (free_order, ((5,), (5,), np.array([1, 1, 3, 0, 3])), ("x", "y"), ("x", "y")),
    (work_both_branches, ((5,),), ("x",), ("return",)), (alloc_like_chain, ((4,),), ("x",), ("return",)),
    (rerun_by_helpers, ((4,),), ("x",), ("return",)), (conditional_helper, ((5,),), ("x",), ("return",)),
    (choice, ((6,),), ("x",), ("return",)), (gain_order, ((5,), (5,)), ("x", "y"), ("y",)),
    (shifted_twice, ((6,), 0.3), ("u", "c"), ("u",)),
]


@pytest.mark.parametrize(("kernel", "given", "wrt", "of", "engine"), each(CASES))
def test_least_trusted(kernel, given, wrt, of, engine):
    rng = np.random.default_rng(5)
    arguments = tuple(rng.random(a) + 0.4 if isinstance(a, tuple) else a for a in given)
    check_derivatives(kernel, arguments, wrt, of, engine=engine)
