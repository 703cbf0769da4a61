"""Passes that meet: loops run again, loops without order, stores that are undone, records that are shared, gains that
are joined."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


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


def squared_in_place(w, a):
    for i in range(w.shape[0]):
        w[i] = w[i] * a * w[i]


def grown_in_place(w, a):
    for i in range(w.shape[0]):
        w[i] = w[i] * 2.0 + a


def same_before_and_after_a_call(x, w, a):
    # repeated: a function of a shadow that the adjoint of a call writes in between
    w[...] += np.exp(x)
    squared_in_place(w, a)
    w[...] += np.exp(x)


def gain_behind_a_call(x, w, a):
    # merge: a gain of what a call's adjoint has not written yet
    w[0] += 3.0 * x[0]
    grown_in_place(w, a)
    x[0] = x[1] * 2.0


def nests_with_calls(x, m, a):
    # joined: the second loop writes rows of what the first one adds to
    for i in range(m.shape[0] - 1):
        m[i + 1, 0] += 3.0 * x[i]
    for i in range(m.shape[0] - 1):
        grown_in_place(m[i], a)


def counting(k, v):
    k[0] += 1
    return v * 2.0


def remainder_of_what_a_call_writes(x, y, k):
    # turned: a remainder that is not the same in all iterations
    n = x.shape[0]
    for i in range(n):
        v = counting(k, x[i])
        y[i] = v + x[k[0] % n] ** 2


def solution_overwritten(m, b, x, z):
    # again: what a solve gave is read by its adjoint, though a loop that runs again writes over it
    y = np.linalg.solve(m, b)
    for i in range(2):
        t = x[i] * x[i]
        for j in range(3):
            t = t * x[j] * np.sin(t)
        y[i] = np.sin(t) * t
    for i in range(m.shape[0]):
        z[i] = y[i] * 3.0


def cut_when_stored(x, k, y):
    # placement: a number does not come back from an array of another dtype
    for i in range(3):
        t = k[i] * x[i]
        k[i] = t
        y[i] = t ** 2


def masks_times_numbers(x, y, z):
    # promotion, algebra: a mask times a number is of integers, and their sum is a sum
    twice = (x > 0.7) * 2
    z[...] = z * ((x > 0.7) * 1 + (y > 0.7) * 1)
    for i in range(x.shape[0]):
        z[i] = z[i] ** 2 * ((x[i] > 0.7) * 1 + (y[i] > 0.7) * 1) * (1 + twice[i] * x[i])


MATRIX = np.eye(5) * 4.0 + np.arange(25.0).reshape(5, 5) / 25.0
CASES = [
    (same_before_and_after_a_call, ((5,), (5,), 1.3), ("x", "w", "a"), ("w",)),
    (gain_behind_a_call, ((5,), (5,), 1.3), ("x", "w", "a"), ("x", "w")),
    (nests_with_calls, ((5,), MATRIX, 1.3), ("x", "m", "a"), ("m",)),
    (remainder_of_what_a_call_writes, ((5,), (5,), np.array([0])), ("x",), ("y",)),
    (solution_overwritten, (MATRIX, (5,), (5,), (5,)), ("m", "b", "x"), ("z",)),
    (cut_when_stored, ((5,), np.array([2, 5, 3]), (5,)), ("x",), ("y",)),
    (masks_times_numbers, ((5,), (5,), (5,)), ("x", "z"), ("z",)),
    (double_write, ((5,), (5,)), ("x", "y"), ("x",)),
    (rerun_left_over, ((4,), (3,), (3,)), ("x", "y", "work"), ("return", "work")),
    (free_order, ((5,), (5,), np.array([1, 1, 3, 0, 3])), ("x", "y"), ("x", "y")),
    (work_both_branches, ((5,),), ("x",), ("return",)), (alloc_like_chain, ((4,),), ("x",), ("return",)),
    (rerun_by_helpers, ((4,),), ("x",), ("return",)), (conditional_helper, ((5,),), ("x",), ("return",)),
    (choice, ((6,),), ("x",), ("return",)), (gain_order, ((5,), (5,)), ("x", "y"), ("y",)),
    (shifted_twice, ((6,), 0.3), ("u", "c"), ("u",)),
]


def cases():
    for kernel, given, wrt, of in CASES:
        rng = generator(5)
        yield Case(kernel, tuple(rng.random(a) + 0.4 if isinstance(a, tuple) else a for a in given), wrt, of)
