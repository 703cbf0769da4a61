"""What asks an array as a whole, `np.argmax(a)`, is asked once: where it stands, before the array is written."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

B4 = np.array([3.2, 0.4, 1.3, 2.6])
A = np.array([[1.1, 2.3, 0.7], [0.4, 1.9, 3.2], [2.7, 0.6, 1.3]])


def largest(a):
    a[np.argmax(a)] *= 0.1


def row_of_the_largest(a):
    a[np.argmax(a[:, 0])] *= 0.1


def column_of_the_largest(a):
    a[:, np.argmax(a[0])] *= 0.1


def column_of_the_least(a):
    a[:, np.argmin(a[0])] = 5.0 * a[:, 0]


def counted(a):
    a[np.count_nonzero(a > 2) - 1] *= 0.1


def in_values(a, b):
    a[0] = np.argmax(a) * b[0]
    a[1] = np.count_nonzero(a > 1) * a[2]


def in_factors(a):
    a[0] *= 0.1 * (np.argmax(a) + 1)
    a[1] *= 0.1 * (np.argmax(a) + 1)
    a[3] *= 0.1 * (np.argmax(a) + 1)


def in_a_loop(a, b):
    t = 0.0
    for i in range(4):
        a[i] *= 0.5 * b[i]
        t += a[i] * np.count_nonzero(a > 1)
        a[(i + 1) % 4] *= 1.5
    return t


def of_two_arrays(a, b):
    for i in range(4):
        a[i] *= 0.5 * b[i] * np.all(a < 3) + np.searchsorted(b, 1.0)
        b[i] *= 1.0 + 0.1 * np.count_nonzero(a[i] > 1)


def of_numbers(a, k):
    for i in range(4):
        a[i] *= 1.0 + np.count_nonzero(a[i] > 1.0) + np.count_nonzero(k[i]) + np.count_nonzero(a[i - 1])


def squares_of_the_largest(a, k):
    s = 0.0
    for _ in range(k):
        s += a[np.argmax(a)] ** 2
        a[np.argmax(a)] = 0.0
    return s


def of_a_view(a):
    v = a[:3]
    v[np.argmax(v)] *= a[3]


def bump(u, k):
    u[k] = u[k] ** 2 + u[0]


def as_an_argument(a):
    bump(a, np.argmax(a))
    bump(a, int(np.argmin(a)) + 1)


def least(u):
    u[np.argmax(u)] = 0.5 * u[0]


def in_a_helper(a):
    least(a)
    least(a)


def two_places(a):
    a[np.argmax(a)], a[np.argmin(a)] = a[0] * 2, a[1] * 3


def sought(a, b):
    for i in range(3):
        a[np.searchsorted(a, b[i])] *= b[i]


def pivots(a):
    for k in range(3):
        a[k:][np.argmax(np.abs(a[k:, k]))] *= 2.0


B = np.array([0.53, 1.71, 2.23, 0.92])


def cases():
    for kernel in (largest, counted, in_factors, of_a_view, as_an_argument, in_a_helper, two_places):
        yield Case(kernel, (B4,), ("a",), ("a",))
    for kernel in (row_of_the_largest, column_of_the_largest, column_of_the_least, counted, pivots):
        yield Case(kernel, (A,), ("a",), ("a",))
    yield Case(in_values, (B4, B), ("a", "b"), ("a",))
    yield Case(in_a_loop, (B4, B), ("a", "b"), ("a", "return"))
    yield Case(of_two_arrays, (B4, np.array([0.5, 0.9, 1.4, 2.5])), ("a", "b"), ("a", "b"))
    yield Case(of_numbers, (B4, np.array([0, 2, 0, -1])), ("a",), ("a",))
    yield Case(squares_of_the_largest, (B4, 2), ("a",), ("a", "return"))
    yield Case(sought, (np.array([0.5, 0.9, 1.4, 2.5, 9.0]), B4), ("a", "b"), ("a",))
