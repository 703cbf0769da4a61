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


def cases():
    x = np.array([0.7, 1.3, 0.4])
    yield Case(numbers, (x,), "x")
    yield Case(promoted, (np.float32(x),), "x")
    twice = "a number in an array without axes has two names, and is added to in place: leave np.array out"
    yield Case(under_two_names, (x,), refused=f"S201 at `c = np.array(0.3)`: {twice}")
    yield Case(in_an_object, (x,), refused=f"S201 at `self.k`: {twice}")
    yield Case(of_a_function, (x,), refused=f"S201 at `return np.asarray(s)`: {twice}")
    yield Case(in_a_function, (x,), refused="S201 at `grown(c, x)`: a number in an array without axes is given to a "
               "function that adds to it in place: leave np.array out")
