"""Work arrays that a loop allocates anew, in a size that changes from iteration to iteration."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def triangle(x):
    total = 0.0
    for i in range(x.size):
        w = np.zeros(i + 1)
        for j in range(i + 1):
            w[j] = x[j] * x[i]
        for j in range(i + 1):
            total += w[j] * w[j] * x[j]
    return total


def read_after_the_loop(x):
    total = 0.0
    for i in range(x.size):
        w = np.ones(x.size - i)
        for j in range(w.size):
            w[j] *= x[j] * x[i]
        total += math.sin(w[0])
    for j in range(w.shape[0]):
        total += w[j] * w[j]
        w[j] = w[j] * x[j]
    return total * w[0]


def inner_loop_outer_size(x):
    total = 0.0
    for i in range(1, x.size):
        for j in range(3):
            w = np.empty(i + j)
            for k in range(i + j):
                w[k] = x[i] * x[j] + k
            for k in range(i + j):
                total += w[k] ** 3
        x[i] = total * 0.01
    return total


def size_from_data(x):
    total, left = 0.0, 9
    while left > 1:
        k = 1 + int(abs(x[left % 4]) * 3.0)
        w = np.zeros(k)
        for j in range(k):
            w[j] = x[j % 4] * x[left % 4]
            total += w[j] * w[j]
        x[left % 4] = 0.3 + 0.1 * math.sin(total)
        left -= k
    return total


def two_arrays(x, counts):
    total = 0.0
    for i in range(counts.size):
        a = np.zeros(counts[i])
        b = np.ones(2 * counts[i] + 1)
        for j in range(counts[i]):
            a[j] = x[j] * x[i]
            b[2 * j] = a[j] * b[2 * j + 1] * x[j]
        for j in range(b.size):
            total += b[j] * b[j] * a[j // 3]
    return total


def nonlinear_in_place(x):
    total = 0.0
    for i in range(x.size):
        w = np.full(i + 2, x[i])
        for _ in range(3):
            for j in range(1, i + 2):
                w[j] = math.sin(w[j] * w[j - 1]) + x[i]
        for j in range(i + 2):
            total += w[j]
    return total


def filled(w, x, i):
    for j in range(w.size):
        w[j] = w[j] * x[i] + x[j % x.size] * w[j] * w[j]


def helper_writes(x):
    total = 0.0
    for i in range(x.size):
        w = np.ones(i + 1)
        filled(w, x, i)
        filled(w, x, 0)
        for j in range(w.size):
            total += w[j] * w[j]
    return total


def helper_writes_in_a_loop(x):
    total = 0.0
    for i in range(x.size):
        w = np.ones((i + 1, 2))
        for s in range(2):
            for r in range(i + 1):
                filled(w[r], x, s)
            w[0, s] *= x[i]
        total += np.sum(w * w)
    return total


def copies_of_rows(m):
    total = 0.0
    for i in range(m.shape[0]):
        w = np.zeros((i + 1, m.shape[1]))
        for j in range(i + 1):
            for k in range(m.shape[1]):
                w[j, k] = m[j, k] * m[i, k]
        old = w.copy()
        row = w[i].copy()
        for j in range(i + 1):
            for k in range(m.shape[1]):
                w[j, k] = w[j, k] * old[i, k] + row[0]
        m[i, 0] = np.sum(w * old) * 0.1
        total += m[i, 0] * w[0, 1]
    return total


def early_break(x):
    total = 0.0
    for i in range(x.size):
        w = np.zeros(i + 1)
        w[i] = x[i] * x[0]
        total += w[i] * w[0]
        if total > 0.9:
            break
        w[0] = math.exp(x[i])
        total += w[0] * w[i]
    return total * x[1]


def listed_scalars(x):
    total = 0.0
    for i in range(x.size - 1):
        w = np.array([x[i], x[i + 1] * x[i], 2.0])
        v = np.zeros(i + 1)
        for j in range(3):
            w[j] *= w[j - 1]
            v[j % (i + 1)] += w[j] * w[0]
        total += v[0] * v[i]
    return total


def in_both_branches(x):
    total = 0.0
    for i in range(x.size):
        if x[i] > 0.7:
            w = np.zeros(i + 1)
        else:
            w = np.full(2 * i + 3, x[i])
        for j in range(w.size):
            w[j] += x[j % 4] * x[i]
        for j in range(w.size):
            total += w[j] ** 2 * w[0]
    return total


def in_both_branches_outside(x):
    k = int(x[0] * 5.0)
    if x[1] > 0.5:
        k += 1
        w = np.ones(k)
    else:
        w = np.full(3, x[0])
    total = 0.0
    for j in range(w.size):
        w[j] *= x[j % 4]
        total += w[j] ** 2
    return total


def in_one_branch(x):
    total = 0.0
    for i in range(x.size):
        if x[i] > 0.6:
            w = np.zeros(i + 2)
            for j in range(w.size):
                w[j] = x[i] * x[j % 4]
                total += math.sin(w[j] * w[0])
        total = total * x[i]
    return total


def allocates(x, k):
    w = np.zeros(k)
    total = 0.0
    for j in range(k):
        w[j] = x[j % x.size] ** 2
        total += w[j] * w[j]
    return total


def helper_allocates(x):
    total = 0.0
    for i in range(x.size):
        total += allocates(x, i + 1) * x[i]
    return total


def only_some_outer_iterations(x):
    total = 0.0
    for i in range(x.size):
        for j in range(2 if i % 2 == 0 else 0):
            w = np.ones(i + j + 1)
            w[0] = x[i] * x[j]
        total += w[0] * w[0] * x[i]
        w[0] = w[0] * x[i]
    return total


def negative_subscripts(x):
    total = 0.0
    for i in range(x.size):
        w = np.zeros(i + 1)
        w[-1] = x[i] * x[0]
        w[0] += x[-1 - i] ** 2
        total += w[-1] * w[0]
    return total


def integers(x):
    total = 0.0
    for i in range(x.size):
        order = np.zeros(i + 1, dtype=np.int64)
        for j in range(i + 1):
            order[j] = (j * j + i) % x.size
        for j in range(i + 1):
            total += x[order[j]] * x[order[0]] * x[i]
        x[order[i]] *= 0.5 * total
    return total


def state_between(u, x):
    for _ in range(3):
        for i in range(1, u.size):
            w = np.empty(i)
            for j in range(i):
                w[j] = u[j] * u[i] * x[j]
            for j in range(i):
                u[i] += 0.1 * w[j] * w[j]
                w[j] = u[i]
                u[j] -= 0.1 * w[j] * u[j]


def linear_only(x, y):
    for i in range(x.size):
        w = np.zeros(i + 1)
        for j in range(i + 1):
            w[j] += 3.0 * x[j]
        for j in range(i + 1):
            y[i] += 2.0 * w[j]


def stop_is_a_size(x):
    total = 0.0
    for i in range(x.size - 1):
        w = np.zeros(i + 2)
        total += x[w.size - 1] * x[i]
    x[w.size - 2] = 0.5 * total * x[0]
    x[w.size - 3] *= x[1]
    return total


def two_in_a_row(x):
    total = 0.0
    for i in range(x.size):
        w = np.zeros(i + 1)
        w[0] = x[i] ** 2
        first = w[0]
        w = np.full(2 * i + 1, first)
        w[i] *= x[0]
        total += w[i] * w[0] * first
    return total


def swept(x):
    total = 0.0
    for i in range(x.size):
        w = x[:].copy()
        v = np.zeros(i + 1)
        for j in range(w.size):
            w[j] = w[j] * x[i]
            v[j % (i + 1)] += w[j] * w[j]
        v *= v
        total += np.sum(v)
    return total


def sized_by_another(x):
    total = 0.0
    for i in range(x.size):
        v = np.full(i + 1, x[i])
        for s in range(2):
            w = np.zeros_like(v)
            z = np.ones(len(w) + s)
            for j in range(i + 1):
                w[j] = v[j] * x[j] * z[j]
                z[j] = w[j] * w[0]
            for j in range(i + 1):
                v[j] = w[j] * w[j] + z[j]
        total += np.sum(v)
    return total


def linear_by_counters(x, y):
    width = int(3.0 * x[0])
    for i in range(x.size - 1, -1, -2):
        for j in range(i, width + 3):
            w = np.zeros((j - i + width, 2))
            for k in range(w.shape[0]):
                w[k, k % 2] += 3.0 * x[k % 4] - y[i]
            if x[i] > 0.8:
                continue
            for k in range(w.shape[0]):
                y[k % 4] += 0.1 * w[k, 0] - 0.2 * w[k, 1]


def linear_until_a_break(x, y):
    for i in range(x.size):
        w = np.zeros(i + 1)
        w[0] = x[i]
        w[i] += 2.0 * x[0]
        if y[i] > 0.9:
            break
        y[i] += w[0] + w[i]
    while y[0] < 3.0:
        for i in range(x.size):
            w = np.empty(2 * i + 1)
            w[:] = x[i]
            y[i % 2] += np.sum(w)


def linear_by_what_changes(x, y):
    size = 1
    for i in range(x.size):
        for j in range(2):
            w = np.zeros(size + j)
            w[0] = x[i]
            w[-1] -= y[j] * x[j]
            y[i] += w[0] + 2.0 * w[-1]
        v = np.zeros(w.size)
        v[0] = x[i] ** 2
        size += int(3.0 * x[i])
        y[i] -= v[0] * w[0]


def adds_up(w, x, i):
    for j in range(w.size):
        w[j] += x[j % 4] * (i + 1)


def helper_adds(x, y):
    for i in range(x.size):
        w = np.zeros(i + 1)
        adds_up(w, x, i)
        adds_up(w, x, 2)
        y[i] += np.sum(w) * x[0]


def of_other_types(x, y):
    for i in range(x.size):
        w = np.zeros(i + 2, dtype=np.complex128)
        taken = np.zeros(i + 2, dtype=np.bool_)
        taken[i] = True
        w[i] = x[i]
        for j in range(i + 2):
            y[j % 4] += w[j].real if taken[j] else x[j % 4]


def backwards(x, y):
    for i in range(1, x.size):
        x[i::-1] += 0.5 * x[:i + 1]
        y[:i] = 2.0 * y[i - 1::-1] + x[i:0:-1] * x[0]
        x[3 - i::-1] = y[:4 - i]


COUNTS = np.array([2, 1, 4, 3])
CASES = [
    (triangle, ("x",), ("return",)), (read_after_the_loop, ("x",), ("return",)),
    (inner_loop_outer_size, ("x",), ("return", "x")), (size_from_data, ("x",), ("return", "x")),
    (two_arrays, ("x",), ("return",)), (nonlinear_in_place, ("x",), ("return",)), (helper_writes, ("x",), ("return",)),
    (helper_writes_in_a_loop, ("x",), ("return",)), (copies_of_rows, ("m",), ("return", "m")),
    (early_break, ("x",), ("return",)), (listed_scalars, ("x",), ("return",)), (in_both_branches, ("x",), ("return",)),
    (in_both_branches_outside, ("x",), ("return",)), (in_one_branch, ("x",), ("return",)),
    (helper_allocates, ("x",), ("return",)), (only_some_outer_iterations, ("x",), ("return",)),
    (negative_subscripts, ("x",), ("return",)), (integers, ("x",), ("return", "x")),
    (state_between, ("u", "x"), ("u",)), (linear_only, ("x", "y"), ("y",)), (stop_is_a_size, ("x",), ("return", "x")),
    (linear_by_counters, ("x", "y"), ("y",)),
    (linear_until_a_break, ("x", "y"), ("y",)), (linear_by_what_changes, ("x", "y"), ("y",)),
    (helper_adds, ("x", "y"), ("y",)), (of_other_types, ("x", "y"), ("y",)), (backwards, ("x", "y"), ("x", "y")),
    (two_in_a_row, ("x",), ("return",)), (swept, ("x",), ("return",)), (sized_by_another, ("x",), ("return",)),
]


def carried_under_a_condition(x):
    total = 0.0
    w = np.ones(1)
    for i in range(x.size):
        if x[i] > 0.6:
            w = np.full(i + 1, x[i])
        total += w[0] * x[i]
    return total


def of_the_iteration_before(x):
    total = 0.0
    for i in range(x.size):
        if i > 0:
            total += w[0] * x[i]  # noqa: F821
        w = np.full(i + 1, x[i])  # noqa: F841
    return total


def cases():
    # changing size
    for kernel, wrt, of in CASES:
        rng = generator(5)
        names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
        arguments = tuple(COUNTS if n == "counts" else 0.3 + 0.7 * rng.random((4,
                3) if n == "m" else 4) for n in names)
        yield Case(kernel, arguments, wrt, of)
    yield Case(carried_under_a_condition, (np.array([0.4, 0.9, 0.8, 1.2]),), "x")
    # an array of an earlier iteration is refused where the text does not show that there is one
    yield Case(of_the_iteration_before, (np.array([0.4, 0.9, 0.8, 1.2]),),
               refused="S201 at `w`: 'w' may stand for different arrays here: copy into one array with x[...] = ..., "
               "or use two names")
