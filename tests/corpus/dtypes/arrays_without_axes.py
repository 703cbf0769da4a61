"""A number in an array without axes, `np.array(0.5)`, which is a number of NumPy's."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


class Held:
    def __init__(self, k):
        self.k = np.array(k)
        self.other = self.k

    def grow(self, by):
        self.k += by


def numbers(x):
    c, k = np.array(0.3), np.asarray(2)
    t = np.array(x[0] * 2, dtype=float)
    c += x[1]
    return np.sum(x * c) + float(c) + t * k + c ** k + np.max(np.array(x[2])) * Held(x[0]).other


def promoted(x):
    c = np.array(0.3)
    y = x * c
    return np.sum(y * y)


def under_two_names(x):
    c = np.array(0.3)
    d = c
    d += x[0]
    return np.sum(x * c)


def in_an_object(x):
    held = Held(x[0])
    held.grow(x[1])
    return held.k * held.other


def summed(x):
    s = 0.0
    for v in x:
        s += v
    return np.asarray(s)


def of_a_function(x):
    c = summed(x)
    d = c
    d += x[0]
    return c * d + summed(x * 2)


def grown(c, x):
    for i in range(x.size):
        c += x[i] * c
    return c * 2


def in_a_function(x):
    c = np.array(0.3)
    return grown(c, x) + c * x[1]


def with_axes(x):
    m = x[1].reshape(1, 1)
    m[0, 0] = x[0] * 3.0
    c = np.array(x[0] * 0.5)
    n = c.reshape(-1, 1) * 2.0
    n[0, 0] += x[2]
    s = 0.0
    for i in range(x.size):
        column = x[i].reshape(-1, 1)
        s += (column.T @ column + column)[0, 0] * np.reshape(x[i], (1,))[0] + np.sum(x[i].reshape(()))
    return np.sum(m @ n) + x[1] * c + s


def copied_and_turned(x):
    s = 0.0
    for i in range(x.size):
        v = x[i].copy()
        s += v.T * 2.0 + np.copy(v * 2) * x[i].squeeze() + v.item()
        v += 1.0
        s *= v
    return s


def copied_under_two_names(x):
    c = np.copy(x[0] * 2)
    d = c
    d += 1.0
    return c * x[1]


def choice_with_axes(x):
    w = np.where(x[0] > 0.1, x[1], x[2])
    m = w.reshape(1, 1)
    return np.sum(m @ m) * w


def written_row(x):
    c = np.array(x[0] * 0.5)
    m = c.reshape(1, 1)
    row = m[0]
    row[0] = x[1] * 3.0
    return c * x[2]


def written_vector(x):
    c = np.array(x[0] * 0.5)
    m = c.ravel()
    m[0] = x[1] * 3.0
    return c * x[2]


def written_without_a_name(x):
    c = np.array(x[0] * 0.5)
    np.atleast_1d(c)[0] = x[1]
    return c * x[2]


def written_number(x):
    c = np.array(x[0] * 0.5)
    m = np.reshape(c, (1, 1))
    c += x[1]
    return c * x[2] + m[0, 0]


def the_same_again(x):
    c = np.array(x[0] * 0.5)
    d = np.asarray(c)
    d += x[1]
    return c * x[2]


def written_choice(x):
    w = np.where(x[0] > 0.1, x[1], x[2])
    m = w.reshape(1)
    m[0] = x[0]
    return w * x[1]


def fill(m, v):
    m[0] = v
    for _ in range(3):
        m[0] *= v


def written_in_a_function(x):
    c = np.array(x[0] * 0.5)
    fill(c.reshape(1), x[1])
    return c * x[2]


def cases():
    x = np.array([0.7, 1.3, 0.4])
    yield Case(numbers, (x,), "x")
    yield Case(promoted, (np.float32(x),), "x")
    twice = (
        "a number in an array without axes has two names, and is added to in place: make it a number: float(a)")
    yield Case(under_two_names, (x,), refused=f"S201 at `c = np.array(0.3)`: {twice}")
    yield Case(in_an_object, (x,), refused=f"S201 at `self.k`: {twice}")
    yield Case(of_a_function, (x,), refused=f"S201 at `return np.asarray(s)`: {twice}")
    yield Case(in_a_function, (x,), refused="S201 at `grown(c, x)`: a number in an array without axes is given to a "
               "function that adds to it in place: make it a number: float(a)")
    yield Case(with_axes, (x,), "x")
    yield Case(choice_with_axes, (x,), "x")
    yield Case(copied_and_turned, (x,), "x")
    yield Case(copied_under_two_names, (x,), refused=f"S201 at `c = np.copy(x[0] * 2)`: {twice}")
    for kernel, place in ((written_row, "c.reshape(1, 1)"), (written_vector, "c.ravel()"),
                          (written_without_a_name, "np.atleast_1d(c)"), (written_number, "np.reshape(c, (1, 1))"),
                          (the_same_again, "np.asarray(c)"), (written_choice, "w.reshape(1)"),
                          (written_in_a_function, "c.reshape(1)")):
        yield Case(kernel, (x,), refused=f"S201 at `{place}`: a view of a number in an array without axes, and one of "
                   "them is written: make the array of the number: np.array([a]), np.full((1, 1), a)")
