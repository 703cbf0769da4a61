"""Short idioms: the largest of a list, newaxis by its name, a call that is returned, comprehensions as arguments."""
from __future__ import annotations

import sys

import numpy as np
from numpy import newaxis

from tests.corpus import Case

X = np.array([0.3, 1.1, 0.7])
GRID = np.linspace(0.0, 1.0, 3)


def extremes(x):
    h = []
    for i in range(x.size):
        h.append(x[i] ** 2)
        if i == 1:
            h.append(max(h) * 0.5 + min(h))
    return max(h) * min(h) + h[2]


def axes(x):
    g = GRID
    return (x[:, newaxis] * np.sin(x)[newaxis, :] * g).sum()


def halved(q, k):
    q[0] = q[1] ** k
    if k > 2:
        return
    q[1] = q[2] * 2.0


def passed_on(q):
    return halved(q, 2)


def returned(q):
    if q[0] > 5.0:
        return passed_on(q)
    q[2] = q[0] * q[1]
    return passed_on(q)


def norm(v):
    return np.sqrt(v @ v)


def changed(v):
    v[0] = v[0] * 2.0
    return v.sum()


def arguments(x):
    return norm(np.array([x[i] - x[i - 1] for i in range(1, 3)])) * norm(np.array([v ** 2 for v in x]))


def in_order(x):
    z = x * 1.0
    s = changed(z) * norm(np.array([v ** 2 for v in z])) + z[0] * changed(z)
    return s - sum(v * z[0] for v in z) * changed(z) + max([v ** 2 for v in z])


def stored(x):
    x[0] = 2.0
    return x[1]


def beside_a_call(x):
    z = x * 1.0
    return stored(z) + np.sum(np.array([v * v for v in z])) * z[0]


def calls_inside(x):
    z = x * 1.0
    return z[0] * sum(changed(z) * i for i in range(2)) + norm(np.array([changed(z) for _ in range(2)])) * z[0]


def asserted(x):
    assert np.array_equal(x, x.astype(bool) * x)
    return np.sum(x) * x[0]


def first_one_apart(x):
    before, s = None, 1.0
    for v in x[1:]:
        if before is not None:
            s += (v - before) ** 2
        before = v
    return s * x[0]


def first_object_apart(x):
    pairs, before, s = [], None, x[0]
    for v in x:
        if v > 100.0:
            pairs.append({"v": v})
    for p in pairs:
        if before is not None:
            s += before * p["v"]
        before = p["v"]
    return s * x[1]


class Counting:
    __start = 3

    def __init__(self, k):
        self.__k = k

    def __scaled(self, x):
        return x * 3.0 * self.__k

    def count(self, x):
        self.__k += 1.0
        return self.__scaled(x) + sum(self.__start * v for v in [x, x])


class Doubled(Counting):
    def __init__(self, k):
        super().__init__(k)
        self.__k = 10.0

    def both(self, x):
        return self.count(x) * self.__k


def private_names(x):
    class Local:
        __factor = 2.0

        def __part(self, y):
            return y * self.__factor

        def whole(self, y):
            return self.__part(y) + y

    return Counting(2.0).count(x[0]) + Doubled(x[1]).both(x[0]) + Local().whole(x[2])


def of_the_machine(x):
    return x[0] / (x[1] + sys.float_info.min) if x[1] > sys.float_info.epsilon else x[0]


def flag_of_the_run(x):
    flag, s = False, 0.0
    for v in x:
        if flag is True:
            s += v
        if v > 0.8:
            flag = True
    return s + x[0]


def flag_that_is_known(x):
    flag, s = False, x[0]
    for k in range(3):
        if flag is True:
            s += x[k] * x[0]
        flag = not flag
    return s if (x is True) is False else 0.0


KERNELS = [flag_that_is_known, private_names, of_the_machine, asserted, first_one_apart, first_object_apart,
           extremes, axes, arguments, in_order, beside_a_call, calls_inside]


def maybe(x):
    s = 0.0
    while sum(v for v in x) + s < 5.0:
        s += x[0]
    return s if s > 0.0 else norm(np.array([v for v in x]))


def cases():
    # idioms
    for kernel in KERNELS:
        yield Case(kernel, (X,), ("x",))
    # a call that returns nothing
    yield Case(returned, (X,), ("q",), ("q",))
    yield Case(passed_on, (X.astype("float32"),), ("q",), ("q",))
    yield Case(flag_of_the_run, (X,), refused="S201 at `flag is True`: whether something is True is asked, which "
               "only the run knows: test it as it is: if flag, or if not flag")
    # sizes and types
    yield Case(axes, (X[:1],), ("x",))
    yield Case(extremes, (X.astype("float32"),), ("x",))
    yield Case(maybe, (X,), "x")
    yield Case(first_one_apart, (X[:1],), ("x",))
