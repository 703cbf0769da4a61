"""Operands and items are evaluated when Python evaluates them, and no more of them than it does."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])
Z = np.array([0.3 + 1.0j, 0.7 - 0.2j, 1.1 + 0.4j])


class Field:
    """An array, and how often it was changed."""

    def __init__(self, u):
        self.u, self.calls = u, 0

    def halved(self, k, limit=0.4):
        self.calls += 1
        self.u[k] *= 0.5
        return self.u[k] > limit

    def place(self):
        self.u[0] *= 3.0
        return 1


def values_of_or_and_and(x):
    f = Field(x.copy())
    s = (x[0] or 2.0) * (x[1] and 3.0) + (0.0 * x[2] or x[3] or f.u[0])
    t = (x[1] > 5.0 or x[2]) * (x[0] and x[1] and f.u[3])
    return s * t + (2.0 if x[0] or f.calls else 5.0)


def operands_with_statements(x):
    f = Field(x.copy())
    if f.halved(0) or f.halved(1, 0.1) or f.halved(2) or f.halved(3):
        f.u *= x[0]
    done = f.halved(3) and f.halved(2, 5.0) and f.halved(1)
    return np.sum(f.u ** 2) * (3.0 if done else 2.0) + (f.u[0] * 0.0 or f.place() * x[0] or f.place())


def value_before_its_place(x):
    f = Field(x.copy())
    us = [x[0], x[1]]
    us[f.place()] = f.u[0]
    f.u[f.place()] = f.u[0] * 2.0
    us[f.place()], f.u[3] = f.u[0], f.u[f.place()]
    return us[1] * f.u[0] + f.u[1] * f.u[3]


def any_of_methods(x):
    f = Field(x.copy())
    s = 1.0 if any(f.halved(k) for k in range(4)) else 2.0
    s += 3.0 if all(f.halved(k) for k in range(4)) else 4.0
    s += 5.0 if any(map(f.halved, (3, 2, 1))) else 6.0
    s += f.calls if any(v > 0.7 and f.halved(0) for v in f.u if v > 0.2) else 0.5
    return s * np.sum(f.u ** 2)


def items_as_far_as_asked(x):
    f = Field(x.copy())
    if any(f.u[k] > 0.1 and f.u[k + 3] > 0.1 for k in range(3)):
        return f.u[0] * x[1]
    return x[1]


def next_of_a_generator(x):
    f = Field(x.copy())
    first = next(f.u[k] for k in range(4) if f.halved(k))
    other = next((v * 2.0 for v in f.u if v > 50.0), x[0])
    return first * other + f.calls * np.sum(f.u)


def chained_comparisons(x):
    f = Field(x.copy())
    s = 1.0
    if 0.0 < f.place() < f.place() * f.u[3] < 9.0:
        s = 2.0
    if 50.0 < f.place() * f.u[0] < f.place():
        s += 7.0
    return s * np.sum(f.u)


def starred_arguments(x):
    f = Field(x.copy())
    us = [f.u[0], x[1]]
    a, b, c = (*(v * 1.0 for v in f.u[:2]), f.place() * 2.0)
    total = summed(*us, us.append(x[3]), *us)
    return total * a + b * c


def summed(a, b, nothing, *rest):
    return a * 2.0 + b + len(rest) * rest[-1]


def generator_of_what_was_there(x):
    us = [x[0], x[1]]
    doubled = (v * 2.0 for v in us)
    us = [x[2]]
    return sum(doubled) * us[0] * Field(x).u[3]


def sum_is_another_array(x):
    u = Field(x * 1.0).u
    s, t = sum([u]), sum([u, u])
    s[0] = 5.0
    t *= 2.0
    return np.sum(u ** 2) + np.sum(s * t)


def true_counts_as_one(x):
    m = Field(x).u > 0.5
    return sum([m[0] + 0.0, m[1] * 1.0, 0.5]) * x[0] + sum([v > 0.5 for v in Field(x).u]) * x[1]


def complex_constants(z):
    f = Field(z * (0.5 + 0.1j))
    f.u[::2] *= 2.0 - 1j
    return f.u


class Ticks:
    """How often it was asked, which no statement of a kernel's own counts."""

    def __init__(self):
        self.n = 0

    def next(self, _=0):
        self.n += 1
        return self.n

    def __bool__(self):
        return self.next() > 1

    def __eq__(self, other):
        return self.next() == 2

    __hash__ = None


def no_further_than_the_first_that_decides(x):
    a, b, c, d = Ticks(), Ticks(), Ticks(), Ticks()
    found = any(a.next() > 1 for _ in range(5)), all(b.next() < 3 for _ in range(5) if b.next() < 4)
    found = found, 2 in (c.next() for _ in range(5)), any([d, d, d, d]), any(k > x[1] for k in map(d.next, range(9)))
    return a.n * x[0] + b.n * x[1] + c.n * x[2] + d.n * x[3]


def membership_asks_items_in_turn(x):
    a, b, c = Ticks(), Ticks(), Ticks()
    s = (2.0 if b in [a, a, b] else 3.0) + (5.0 if 7 not in (c, x[0], c.next()) else 7.0)
    return s * x[0] + a.n * x[1] + b.n * x[2] + c.n * x[3]


def a_key_is_asked_for_once(x):
    a, b = Ticks(), Ticks()
    most, least = max([1, 2, 3], key=a.next), min((1, 2, 3), key=lambda k: -b.next(k))
    return a.n * x[0] + b.n * x[1] + most * x[2] + least * x[3] + max([], key=a.next, default=x[0])


def cases():
    for kernel in (values_of_or_and_and, operands_with_statements, value_before_its_place, any_of_methods,
                   items_as_far_as_asked, next_of_a_generator, chained_comparisons, starred_arguments,
                   generator_of_what_was_there, sum_is_another_array, true_counts_as_one,
                   no_further_than_the_first_that_decides, membership_asks_items_in_turn, a_key_is_asked_for_once):
        yield Case(kernel, (X,), "x")
    yield Case(complex_constants, (Z,), "z")
