"""Membership, ranges with names, constants of classes, limits of types, and other spellings of what has a rule."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(4)
X, M = RNG.random(5) + 0.2, RNG.random((5, 2)) + 0.2


def members(x):
    s, n = 0.0, len(x)
    for i in range(n):
        if i in (0, n - 1):
            s += x[i] ** 2
        if i % 3 in (0, 2):
            s += x[i] ** 3
        if i not in (0, n - 1):
            s += x[i]
        if i in (2,):
            s *= x[i]
        if i not in [len(x) - 2, -i + 2]:
            s += x[i] * 0.3
    return s


def ranges(x):
    n = x.size
    steps = range(n)
    inner = range(1, n - 1)
    s = 0.0
    for i in steps:
        s += x[i] ** 2 * i
    for i in reversed(inner):
        s = s * x[i] + x[i + 1]
    for i in range(n)[::-1]:
        s = s * x[i] + x[i]
    for i in steps[1:-1]:
        s = s * x[i] + x[i - 1]
    for i in range(1, n)[::2]:
        s = s * x[i] + x[i - 1]
    for k, i in enumerate(inner):
        s += k * x[i]
    return s * len(steps)


def starred(x, m):
    coef, *_ = np.linalg.lstsq(m, x, rcond=None)
    q, *_ = np.linalg.qr(m)
    return np.sum(coef ** 2) + np.sum(q ** 3)


def limits(x):
    eps = np.finfo(float).eps
    most = np.finfo(np.float64).max * 1e-308
    return np.sum(x / (np.sum(x) + eps)) * most + x[0] * np.iinfo(np.int64).max * 1e-18


def parts_of_numbers(x, t):
    whole, rest = 0.0, 0.0
    part, k = math.modf(3.7 * t)
    fractions, wholes = np.modf(4.0 * x)
    whole, rest = k * part, np.sum(fractions ** 2 * wholes)
    return whole * rest * t


def differences(x, m):
    total = np.sum(np.diff(x, prepend=0.0) ** 2) + np.sum(np.diff(x, prepend=x[0] ** 2, append=2.0) ** 3)
    return total * np.sum(np.diff(m, append=m[:, :1] ** 2) ** 2) * np.linalg.trace(m[:2] @ m[3:])


def stepped(x, f=np.sin, k=2.0):
    return f(x) * k


def cube(x):
    return x ** 3


def cubed(x, f=cube):
    return f(x)


def functions_by_default(x):
    return np.sum(stepped(x)) * np.sum(stepped(x, np.cos)) * np.sum(stepped(x, k=3.0)) + np.sum(cubed(x))


CASES = [
    (members, (X,), ("x",)), (ranges, (X,), ("x",)), (starred, (X, M), ("x", "m")), (limits, (X,), ("x",)),
    (parts_of_numbers, (X, 0.9), ("x", "t")), (differences, (X, M), ("x", "m")),
    (functions_by_default, (X,), ("x",)),
]


def by_a_step(x, d):
    s = 0.0
    for i in range(5)[::d]:
        s += x[i] ** 2
    return s


def in_a_loop(x, d):
    s = 0.0
    for k in range(d):
        r = range(k)
        for i in r:
            s += x[i] ** 2
    return s


def picked(x, d):
    r = range(2, 5)
    return x[r[d]] ** 2


def out_of_its_array(x):
    return np.sum(x[-9:2]) * x[0]


def counted_from_a_float(x, d):
    s = 0.0
    for k, v in enumerate(x, 1.5):
        s += k * v
    return s


def cases():
    yield Case(counted_from_a_float, (X, 2), "x", refused="S201 at `1.5`: an enumeration from what is no integer")
    # derivatives
    for kernel, arguments, wrt in CASES:
        yield Case(kernel, arguments, wrt)
    for kernel in (by_a_step, picked, in_a_loop):
        yield Case(kernel, (X, 2), "x")
    # ranges that stay
    # a guard of a slice names its statement
    yield Case(out_of_its_array, (X,), refused=(
        "S501 at `return np.sum(x[-9:2]) * x[0]`: a slice reaches out of its array, where NumPy takes less: "
        "x.shape[0] - 9 is -4: bound it by max(..., 0) or min(..., n)"))
