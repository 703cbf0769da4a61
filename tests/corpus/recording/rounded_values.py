"""Floats that may be recorded in single precision, and floats that may not: something is decided by what they were."""
from __future__ import annotations

from types import FunctionType

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def anew(kernel):
    """The kernel as another function, of which nothing has been derived yet."""
    return FunctionType(kernel.__code__, kernel.__globals__, kernel.__name__)


# -- partials alone read what is recorded -----------------------------------------------------------------------------

def product(x, n):
    for k in range(n):
        for i in range(x.size):
            x[i] = np.sin(x[i]) * x[i] + 0.4 + 0.01 * k
    return np.sum(x)


def by_arrays(x, n):
    for _ in range(n):
        x[1:] = x[1:] * x[:-1] + np.sqrt(1.0 + x[1:])
        x[:] = x / (1.0 + x * x)
    return np.sum(x * x)


def numbers(x, n):
    y, z = 0.3, 0.7
    for k in range(n):
        y, z = np.sin(y * z) + x[k % x.size], np.exp(-y * y) * z
    return y * z


def stirred(x, c):
    for i in range(1, x.size):
        x[i] = x[i] * x[i - 1] * c + np.cos(x[i])


def by_a_helper(x, n):
    for k in range(n):
        stirred(x, 0.5 + 0.01 * k)
    return np.sum(x)


def two_ways_by_number(x, n):
    # which way is known by the counter: nothing of what is recorded is asked
    for k in range(n):
        for i in range(x.size):
            if (i + k) % 3 == 0:
                x[i] = np.sin(x[i]) * x[i] + 0.5
            else:
                x[i] = np.cos(x[i]) * x[i - 1]
    return np.sum(x)


def solved(x, n):
    a = np.eye(x.size) * 3.0
    for _ in range(n):
        a[0, :] = a[0, :] + 0.1 * x * x
        x[:] = np.linalg.solve(a, np.sin(x) + 1.0)
    return np.sum(x)


def rounded():
    x = generator(6).random(6) + 0.3
    return [(k, (x, 12)) for k in (product, by_arrays, numbers, by_a_helper, two_ways_by_number)]


# -- something is decided by it, and the arguments lie within 1e-9 of where it changes --------------------------------

def largest_of_both(x, n):
    for _ in range(n):
        for i in range(1, x.size):
            x[i] = max(x[i] - 0.1, x[i - 1] * x[i])
    return np.sum(x)


def asked_by_a_helper(y, x):
    # the helper's adjoint runs forwards, and goes the way that its argument says
    for i in range(x.size):
        y[i] = y[i] * x[i] if x[i] > 0.5 else y[i] - 3.0 * x[i]


def branch_of_a_helper(x, n):
    y = np.ones(x.size)
    for _ in range(n):
        asked_by_a_helper(y, x)
        x[:] = 1.0 - x
    return np.sum(y)


def sign(x, n):
    y = 0.0
    for k in range(n):
        for i in range(x.size):
            y = y + abs(x[i] - 0.5) * (1.0 + x[i]) * (k + 1.0)
            x[i] = 1.0 - x[i]
    return y


def index_of_a_float(x, n):
    # int() of what is recorded is the index of an element
    table, y = np.array([0.3, 1.7, 0.2]), 0.1
    w = x.copy()
    for _ in range(n):
        for i in range(x.size):
            j = int(2.0 * x[i])
            y = y + w[j % w.size] * x[i] * table[j % 3]
            x[i] = 1.0 - x[i]
    return y


def whole_steps(x, n):
    y = 0.0
    for _ in range(n):
        for i in range(x.size):
            y = y + np.floor(2.0 * x[i]) * x[i] * x[i]
            x[i] = 1.0 - x[i]
    return y


def remainder(x, n):
    y, p = 0.0, 1.0 - x
    for _ in range(n):
        for i in range(x.size):
            y = y + (x[i] % p[i]) * p[i]
            x[i] = 1.0 - x[i]
            p[i] = 1.0 - p[i]
    return y


def largest_element(x, n):
    # the largest is equal to one element only where nothing is rounded
    y = 0.0
    for k in range(n):
        y = y + np.max(x) ** 2 * (k + 1)
        x[:] = 1.0 - x
    return y


def computed_from_it(x, n):
    # what is asked is computed from what is recorded, by several numbers
    y = 0.0
    for _ in range(n):
        for i in range(x.size):
            d = 2.0 * x[i] - 1.0
            e = 3.0 * d
            c = 3.0 if e > 0.0 else -2.0
            y = y + c * x[i] * x[i]
            x[i] = 1.0 - x[i]
    return y


def inner_loop_again(x, n):
    # independent iterations run again from what the outer loop recorded, with their branches
    y = 0.0
    for _ in range(n):
        for i in range(x.size):
            z = x[i]
            for _ in range(3):
                z = z * z * 2.0 if z > 0.5 else z * z - z
            y = y + z * x[i]
        for i in range(x.size):
            x[i] = 1.0 - x[i]
    return y


DECIDING = (branch_of_a_helper, sign, index_of_a_float, whole_steps, remainder, largest_element, computed_from_it,
            inner_loop_again)


def deciding():
    # 1 - x is exact, and goes from one side of 1 / 2 to the other
    x = 0.5 + np.array([1e-9, -2e-9, 3e-9, -1e-9, 2e-9, -3e-9])
    return [(k, (x, 4)) for k in DECIDING]


# -- both in one ------------------------------------------------------------------------------------------------------

def one_of_two(u, v, n):
    for _ in range(n):
        for i in range(u.size):
            u[i] = np.sin(u[i]) * 1.1
            v[i] = abs(v[i] - 0.5) * v[i]
    return np.sum(u) + np.sum(v)


def rotated(z, n):
    for _ in range(n):
        for i in range(z.size):
            z[i] = z[i] * z[i] * (0.6 + 0.2j) + 0.1
    return np.sum(z.real)


def cases():
    for kernel, arguments in rounded():
        yield Case(kernel, arguments, ("x",), ("return",))
    x = generator(7).random(6)
    yield Case(largest_of_both, (x, 4), ("x",), ("return",))
    yield Case(one_of_two, (x, x + 0.6, 4), ("u", "v"), ("return",))
    for kernel in DECIDING:
        yield Case(kernel, (x + 0.01, 3), ("x",), ("return",))
