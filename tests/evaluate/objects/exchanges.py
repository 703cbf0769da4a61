"""Branches in which names exchange what they hold, or bind what they make, and what else holds it keeps it."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])


class Pair:
    """Two arrays, which may change places."""

    def __init__(self, a, b):
        self.a, self.b, self.turns = a, b, 0

    def ordered(self):
        self.turns += 1
        if self.a[0] > self.b[0]:
            self.a, self.b = self.b, self.a
            return self.a
        return self.b


def in_an_object(x):
    p = Pair(x * 2.0, x ** 2)
    s = 0.0
    for k in range(3):
        s += np.sum(p.ordered()) * x[k + 1]
        p.a = p.a + 1.0
    return s * np.sum(p.a * x) + p.turns * np.sum(p.b ** 2)


def held_by_a_third(x):
    p = Pair(x * 2.0, x ** 2)
    a, b = p.a, p.b
    c = a
    if x[1] > 0.5:
        a, b = b, a
    a = a * x[3]
    return np.sum(a * b ** 2) + np.sum(c * p.a) * p.turns


def operands_on_the_way(x):
    p = Pair(x * 2.0, x ** 2)
    s, t = x[0], x[1]

    def exchanged():
        nonlocal s, t
        if p.a[1] > 1.0:
            s, t = t, s * 2.0
        return s
    total = s * 10.0 + exchanged() * s + t
    return total * s + t * p.b[3]


def left_in_the_middle(x):
    p = Pair(x * 1.0, x * 3.0)
    a, b = p.a[0], p.b[1]
    for k in range(4):
        if x[k] > 0.5:
            a, b = b, a
            if x[k] > 1.0:
                break
            r = a * 2.0
        else:
            r = b * x[0]
        a += r ** 2
    return a * x[3] + b * p.turns + b ** 2


def values_given_back(x):
    p = Pair(x * 1.0, x * 3.0)

    def chosen(u, v):
        if u[0] < v[1]:
            w = u
            u, v = v, u
            return w * 2.0 + u, v
        w = v
        return w, u * x[0]
    s, t = chosen(p.a, p.b)
    t, s = chosen(s, t)
    return np.sum(s * t) + p.turns


def first_bound_on_ways(x):
    p = Pair(x * 1.0, x * 3.0)
    s = 0.0
    for k in range(3):
        if x[k] > 0.5:
            r = x[k] * 2.0
            q = r * p.a[k]
        elif x[k] > 0.2:
            q = x[k] ** 2
            r = q
        else:
            r = s
            q = r + 1.0
        s += r * q
        r = q
        s += r
    return s


def old_value_behind_the_new(x):
    p = Pair(x * 1.0, x * 3.0)
    s, t = x[0], x[1]
    if p.a[0] < 1.0:
        u = s * t
        t = s + u
        s = u
    else:
        u = t
        s, t = t, s * 2.0
    return s * t + u


def cases():
    for kernel in (in_an_object, held_by_a_third, operands_on_the_way, left_in_the_middle, values_given_back,
                   first_bound_on_ways, old_value_behind_the_new):
        yield Case(kernel, (X,), "x")
