"""Generator functions, iterators, and loops through them."""

from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 1.4, 0.7])


class Grid:
    def __init__(self, n):
        self.n = n

    def interior(self):
        for i in range(1, self.n - 1):
            k = i
            yield k

    def pairs(self):
        for i in range(self.n):
            for j in range(i):
                if i + j == 3:
                    continue
                yield i, j

    def __iter__(self):
        yield from self.interior()
        yield 0


def stencil(x):
    g = Grid(x.size)
    y = x.copy()
    for i in g.interior():
        y[i] = x[i - 1] * y[i - 1] + x[i + 1]
    return np.sum(y * y)


def pairs(x):
    s = 0.0
    for i, j in Grid(4).pairs():
        if x[i] > 1.2:
            continue
        if i == 3 and j == 1:
            break
        s += x[i] * x[j]
    else:
        s *= 2
    return s


def pairs_n(x):
    s = 0.0
    for k, (i, j) in enumerate(Grid(x.size).pairs()):
        s += x[i] * x[j] * k
    return s


def over(x):
    return sum(x[i] ** 2 for i in Grid(4)) + np.prod([x[i] for i in Grid(4).interior()])


def lazy(x):
    y = x.copy()

    def gen():
        for k in range(3):
            yield y[k] * 2

    s = 0.0
    for v in gen():
        s += v
        y[:] = y * 1.5
    for v in (y[k] * 3 for k in range(3)):
        y[:] = y * v
        s += v
    return s


def ret(x):
    def gen(n):
        k = 0
        while True:
            if k >= n:
                return
            yield k, x[k]
            k += 1

    s = 0.0
    for k, v in gen(3):
        s += v * (k + 1)
    a, (b, c) = gen(2)
    return s * c + list(gen(4))[3][1]


def early(x):
    def gen(a):
        for v in a:
            yield v * v

    def find(t):
        for v in gen(x):
            if v > t:
                return v
        return 0.0 * t

    return find(0.6) * find(1.0)


def returned(x):
    def odd():
        return (x[i] * i for i in range(1, 4))

    t = 0.0
    for v in odd():
        t += v * v
    return t * sum(odd())


def iterator(x):
    it = iter(x)
    a, b = next(it), next(it)
    rest = iter([x[2], x[3]])
    return a * b + next(rest) * next(rest) * next(rest, 2.0)


def cases():
    for kernel in (stencil, pairs, pairs_n, over, lazy, ret, early, returned, iterator):
        yield Case(kernel, (X,), "x")
