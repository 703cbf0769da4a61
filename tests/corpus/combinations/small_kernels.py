"""Small kernels that were once differentiated wrongly or refused, each with what it is about."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def index_from_a_written_array(x, y):
    n = x.size
    x[int(x[0] * 3.0) % n] = y[1] * x[2]
    x[int(x[1] * 3.0) % n] *= y[0]


def changed(u, v, a):
    for i in range(u.size):
        u[i] = a * v[i] * u[i - 1]


def one_array_for_two_parameters(x, a):
    changed(x, x, a)
    changed(x, x, 0.5 * a)


def whole_statement_reads_its_own_target(x):
    x[...] = x * x[1] + x[0]


def recorded_under_a_test(x, q):
    total = 0.0
    for i in range(x.size):
        step = 0
        while step < 3:
            taken = i != 2
            if taken:
                q[i], q[i - 1] = q[i - 1], q[i]
            else:
                total += math.exp(q[i]) * x[i]
            step += 1
    return total


def scaled(a, b):
    return 2.0 * b


def unused_argument_of_a_helper(x):
    for i in range(x.size):
        x[i] = scaled(x[i - 1] * 3.0, x[i] * x[i])


def work_array_whose_content_is_not_read(x):
    work = np.zeros(x.size)
    for i in range(x.size):
        work[i] = x[i] * x[i]
    total = 0.0
    for i in range(work.size):
        total += x[i] ** 3
    return total


def loop_that_only_leaves(x):
    count = 0
    while True:
        count += 1
        if count > 3:
            break
    return x[0] * x[1]


def rows_of_a_matrix(m, q):
    for i in range(m.shape[0]):
        row = m[i]
        row[:] = q
        row *= m[i - 1]


def snapshot_before_a_call(x, y):
    total = 0.0
    for k in range(3):
        total += x[k] * y[k] * x[-1]
        changed(x, y, total)
    return total


def overwritten_within_an_iteration(x, y):
    for i in range(x.size):
        x[i] = x[i] * x[i]
        y[i] = x[i] * 3.0
        x[i] = math.sin(x[i])


def carried_number_from_the_record_of_an_element(u, c):
    left = u[u.size - 1]
    for i in range(u.size):
        here = u[i]
        u[i] = here - c * math.sin(here - left) * left
        left = here


def forward_and_back(x, y, work):
    total = 0.0
    for i in range(x.size):
        for k in range(work.size):
            work[k] = x[i] * y[k]
        for k in range(work.size):
            total += work[k] ** 2 * math.exp(work[k])
    return total


def early_return(x, limit):
    for i in range(x.size):
        for j in range(x.size):
            if x[i] * x[j] > limit:
                return x[i] + x[j] ** 2
    return 0.5 * x[0]


def array_given_whole_and_by_element(x, y):
    y[1] /= 1.0 + y[0] ** 2
    for i in range(1, y.size - 1):
        changed(x, y, 0.5 * y[-1 - i])


def work_array_kept_by_some_iterations(x):
    w = np.ones(2)
    total = 0.0
    for i in range(3):
        if i != 1:
            for j in range(2):
                w[j] = x[i] * x[j]
                w[j] *= w[j]
        for j in range(2):
            total += w[j] * w[j]
    return total


def diagonal_is_not_the_whole(x):
    w = np.ones((3, 3))
    total = 0.0
    for i in range(3):
        for _ in range(3):
            for j in range(3):
                w[j, j] = x[i] * x[j]
        for j in range(3):
            for k in range(3):
                total += w[j, k] * w[j, k] * x[j]
    return total


def allocated_in_a_branch(x):
    total = 0.0
    for i in range(x.size):
        if x[i] > 0.7:
            w = np.zeros(2)
            w[0] += x[i] * x[0]
            total += w[0] ** 2
    return total


def array_of_an_earlier_iteration(x):
    total = 0.0
    for i in range(x.size):
        if i % 2 == 0:
            w = np.zeros(2)
        w[0] += x[i] * x[0]
        total += w[0] ** 2
    return total


def several_spellings(x):
    return min(x[0], x[1], 2.0 * x[2]) * math.log(3.0 + max(x[0], x[1], x[3]), 2.0) + math.log(x[1], 1.5 + x[2])


def sum_with_a_size(x, y):
    y[:] = np.sum(x * x) / len(x)


def loops_left_early_with_stacks(x, y):
    total, trips = 0.5, 0
    while total < 3.0:
        trips += 1
        total = total + 0.02 * math.sin(total) * x[trips % 3]
        if trips == 150:
            break
        if trips % 2 == 0:
            y[trips % 4] *= total
        y[0] = y[0] * total - 0.7 * y[0] * y[1]
    for k in range(x.size - 1, 0, -1):
        y[k] = y[k] * y[k - 1]
        if y[k] > 1e9:
            break
        total *= y[k - 1]
    return total


def loops_of_unknown_length_inside_others(x):
    total = 1.0
    for i in range(x.size):
        part, limit = x[i], 1.5 + x[i]
        while part < limit:
            part = part * (1.02 + 0.01 * math.cos(part * total))
            for k in range(3, 0, -1):
                part = part * (1.0 + 0.001 * math.sin(part * x[k]))
        total = total * part * 0.5
    return total


def where_of_numbers(x, y):
    total = 0.0
    for i in range(x.size):
        y[i] = np.where(x[i] > 0.7, x[i] * y[i], np.where(x[i] > 0.5, 2.0, math.sin(x[i])))
        total += 2.0 * np.where(y[i] > 0.5, y[i], x[i] * x[i]) - y[i]
    return 2.0 * np.where(total > 0.0, total * x[0], -total)


def whole_axes(m):
    for i in range(1, m.shape[0]):
        row, m[i - 1, :] = m[i, :], 2.0 * m[i - 1, :] * m[i]
        for j in range(row.size):
            m[i, j] = row[j] * m[i - 1, :][j]
    m[:, :] = m * m


def products_and_gamma(x):
    return math.prod((x[0], x[1], 2.0)) * math.prod([x[2]]) + math.gamma(x[0] + 0.4) * math.lgamma(x[1] + 2.5)


def choice_under_two_names(x):
    a = np.where(x[0] > 0.0, x[0], x[1])
    b = a
    a += x[2]
    return a * b


def sums_of_rows(m):
    total = 0.0
    for row in m:
        total += np.sum(row * row) / row.size
    for i in range(m.shape[0]):
        total *= np.sum(m[i] * m[0] / m.shape[1])
    return total


def size_of_a_row(x, m):
    row = m[int(x[0] * 2.0)]
    x[2] = row.shape[0] * x[1]
    return x[2] * row[0]


def squares_added(v, w):
    for i in range(v.size):
        v[i] += w[i] * w[i]
    return w[0]


def arrays_computed_in_a_call(x, y):
    squares_added(x, x * y)
    return squares_added(y, np.exp(-x[:] + y)) * x[1]


def sums_into_one_place_recorded(x, y):
    m = x * y
    for k in range(4):
        y[k // 2] += m[k]
    y *= x
    places = np.array([0, 0, 2])
    np.add.at(x, places, m[:3] * x[:3])
    x *= y


def one_or_the_other(x, y, a, c):
    """`or` and `and` give one of their values."""
    total = 0.0
    for i in range(x.size):
        total += (x[i] or 1.0) * (a and y[i])
    z = 0.0 * x[0]
    v = z or y[1] or c
    w = x[2] and (z or c)
    w += (x[1] and x[3] or y[0]) * (a and x[0] or np.where(x[1] or c, y[2], 1.0))
    return total + v * w + squared(x[0] or 2.0) + (squared(z) or squared(y[2]))


def squared(v):
    return v * v


CASES = [
    (one_or_the_other, ("x", "y", "a", "c"), ("return",)),
    (sums_into_one_place_recorded, ("x", "y"), ("x", "y")),
    (arrays_computed_in_a_call, ("x", "y"), ("x", "y", "return")),
    (size_of_a_row, ("x", "m"), ("x", "return")),
    (index_from_a_written_array, ("x", "y"), ("x",)), (one_array_for_two_parameters, ("x", "a"), ("x",)),
    (whole_statement_reads_its_own_target, ("x",), ("x",)), (recorded_under_a_test, ("x", "q"), ("return", "q")),
    (unused_argument_of_a_helper, ("x",), ("x",)), (work_array_whose_content_is_not_read, ("x",), ("return",)),
    (loop_that_only_leaves, ("x",), ("return",)), (rows_of_a_matrix, ("m", "q"), ("m",)),
    (snapshot_before_a_call, ("x", "y"), ("return", "x")), (overwritten_within_an_iteration, ("x", "y"), ("x", "y")),
    (carried_number_from_the_record_of_an_element, ("u", "c"), ("u",)),
    (forward_and_back, ("x", "y"), ("return",)), (early_return, ("x",), ("return",)), (sum_with_a_size, ("x",), ("y",)),
    (work_array_kept_by_some_iterations, ("x",), ("return",)), (diagonal_is_not_the_whole, ("x",), ("return",)),
    (several_spellings, ("x",), ("return",)), (allocated_in_a_branch, ("x",), ("return",)),
    (array_given_whole_and_by_element, ("x", "y"), ("x", "y")),
    (where_of_numbers, ("x", "y"), ("return", "y")), (whole_axes, ("m",), ("m",)),
    (products_and_gamma, ("x",), ("return",)),
    (loops_left_early_with_stacks, ("x", "y"), ("return", "y")),
    (loops_of_unknown_length_inside_others, ("x",), ("return",)),
    (sums_of_rows, ("m",), ("return",)),
]


def _argument(name: str, rng: np.random.Generator, small: bool) -> object:
    if name == "m":
        return 0.3 + rng.random((4, 3))
    if name in ("q", "work"):
        return 0.3 + rng.random(3)
    if name == "x" and small:
        return 0.3 + rng.random(3)
    return {"a": 0.7, "c": 0.4, "limit": 0.6}.get(name, None) or 0.3 + rng.random(4)


def cases():
    # small kernel
    for kernel, wrt, of in CASES:
        rng = generator(3)
        names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
        arguments = tuple(_argument(n, rng, "q" in names and "m" not in names) for n in names)
        yield Case(kernel, arguments, wrt, of)
    # refused for want of a rule
    for kernel in (choice_under_two_names,):
        yield Case(kernel, (np.array([0.4, 0.9, 0.8, 1.2]),), refused=(
            "S301 at `np.where(x[0] > 0.0, x[0], x[1])`: no derivative rule for numpy.where of numbers here: "
            "write it with if and else"))
    yield Case(array_of_an_earlier_iteration, (np.array([0.4, 0.9, 0.8, 1.2]),), "x")
