"""Arms and operands that leave nothing behind but what an object holds."""
from __future__ import annotations

from tests.corpus import Case


class Counter:
    def __init__(self):
        self.k = 1.0

    def set(self, k):
        self.k = k
        return True


def conditional(x):
    c = Counter()
    y = 0.25 if x > 1.0 else 0.5 * c.set(2.0)
    return x * c.k + y


def conjunction(x):
    c = Counter()
    if x > 1.0 and c.set(3.0):
        return x * c.k
    return x * c.k * 7.0


def disjunction(x):
    c = Counter()
    y = x > 1.0 or c.set(4.0)
    return x * c.k if y else x


def chained(x):
    c = Counter()
    if 0.5 < x < c.set(5.0) + 0.2:
        return x * c.k
    return x * c.k * 5.0


def closure(x):
    held = [1.0]

    def put(v):
        held[0] = v
        return 0.0
    y = put(4.0) if x > 1.0 else put(9.0)
    return x * held[0] + y


def tested_by_a_loop(x):
    c = Counter()
    total = 0.0
    while total < x and c.set(6.0):
        total += 0.4 * c.k
    return total * x * c.k


def cases():
    for kernel in (conditional, conjunction, disjunction, chained, closure, tested_by_a_loop):
        for x in (0.3, 0.9, 1.1, 1.7):
            yield Case(kernel, (x,), "x")
