"""Functions that may give their argument itself: the first power of a matrix."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.62])


def operand_written(x):
    m = np.outer(x, x)
    q = np.linalg.matrix_power(m, 1)
    m[0] = 0.0
    return np.sum(q * x)


def power_written(x):
    m = np.outer(x, x)
    q = np.linalg.matrix_power(m, n=1)
    q *= x
    m[0] = 2.0 * q[-1]
    return np.sum(q * m)


def transposed(x):
    m = np.outer(x, x + 1.0)
    q = np.linalg.matrix_power(m.T, 1)
    q[0] = x
    return np.sum(q * m)


def of_a_stack(x):
    m = np.stack((np.outer(x, x), np.outer(x, x + 1.0)))
    q = np.linalg.matrix_power(m, 1)
    q[1] *= x
    return np.sum(q * m)


def others(x):
    m = np.outer(x, x) + np.eye(x.size)
    once, none, square = (np.linalg.matrix_power(m, -1), np.linalg.matrix_power(m, 0), np.linalg.matrix_power(m, 2))
    once *= x
    none[0] = x
    square[0] += x
    m[0] = 2.0
    return np.sum(once * none * square * m)


def in_a_loop(x):
    m = np.outer(x, x)
    total = 0.0
    for k in range(1, 4):
        q = 2.0 * np.linalg.matrix_power(m, k)
        q *= x
        total += np.sum(q * np.linalg.matrix_power(m, k))
    return total


def power_changed(x):
    m = np.outer(x, x)
    total = 0.0
    for k in range(1, 4):
        q = np.linalg.matrix_power(m, k)
        q *= x
        total += np.sum(q)
    return total + np.sum(m)


def operand_changed(x, k):
    m = np.outer(x, x)
    q = np.linalg.matrix_power(m, k)
    m[0] = 0.0
    return np.sum(q * x)


def listed(x):
    m = np.outer(x, x)
    powers = []
    for k in range(1, 3):
        powers.append(np.linalg.matrix_power(m, k))
    m[0] = x
    return np.sum(powers[0] * powers[1])


def cases():
    for kernel in (operand_written, power_written, transposed, of_a_stack, others, in_a_loop):
        for x in (X, X[:1]):
            yield Case(kernel, (x,), ("x",))
    yield Case(listed, (X,), "x")
    for kernel, given, refused in (
            (power_changed, (X,),
             "S201 at `q *= x`: an array is written that NumPy shares with another one, which is a view of it by a "
             "function: write into the array itself, or take a copy: np.copy(...)"),
            (operand_changed, (X, 2),
             "S201 at `m[0] = 0.0`: an array is written that NumPy shares with another one, which is a view of it by "
             "a function: write into the array itself, or take a copy: np.copy(...)")):
        yield Case(kernel, given, "x", refused=refused)
