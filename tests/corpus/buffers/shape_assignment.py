"""Arrays that are given another shape."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.62])


def shaped_twice(x):
    a = np.zeros(4)
    for i in range(4):
        a[i] = x[i] ** 2
    a.shape = 2, 2
    b = a.T @ a
    a.shape = (4,)
    a += x
    return np.sum(a ** 2) + b[0, 1]


def shaped_in_a_loop(x):
    s = 0.0
    for k in range(2):
        a = x * (k + 1.0)
        v = a[1:]
        a.shape = (2, 2)
        a[0] *= a[1]
        v[0] *= 3.0
        s += np.sum(a ** 2)
    return s


def held_by_two(x):
    a = x * 2.0
    b = a
    a.shape = (2, 2)
    return np.sum(b)


def given_back(x):
    a = x * 2.0
    b = same(a)
    a.shape = (2, 2)
    return np.sum(b)


def same(a):
    return a


def argument(x):
    x.shape = (2, 2)
    return np.sum(x @ x)


def made_or_not(x):
    a = x * 2.0
    if x[0] > 0.5:
        a = x
    a.shape = (2, 2)
    return np.sum(a)


def converted(x):
    a = 2.0 * x
    c = np.asarray(a)
    a.shape = (2, 2)
    return np.sum(c[0]) * x[0]


def chosen(x):
    a = 2.0 * x
    c = a if x[0] > 0.0 else x
    a.shape = (2, 2)
    return np.sum(c[0]) * x[0]


def in_a_dict(x):
    a = 2.0 * x
    d = {"a": a}
    a.shape = (2, 2)
    return np.sum(d["a"][0])


def closed_over(x):
    a = 2.0 * x

    def g():
        return a
    c = g()
    a.shape = (2, 2)
    return np.sum(c[0])


def written_into(x):
    a = np.zeros(4)
    b = np.add(x, x, out=a)
    a.shape = (2, 2)
    return np.sum(b[0])


def made_into(x):
    b = np.zeros(4)
    a = np.exp(x, b)
    a.shape = (2, 2)
    return np.sum(b[0])


def cases():
    for kernel in (shaped_twice, shaped_in_a_loop, held_by_two, given_back):
        yield Case(kernel, (X,), ("x",))
    for kernel in (in_a_dict, closed_over):
        yield Case(kernel, (X,), "x")
    # other names would have the shape, too
    for kernel in (argument, made_or_not, converted, chosen, written_into, made_into):
        part = "x.shape" if kernel is argument else "a.shape"
        yield Case(kernel, (X,), refused=(
            f"S201 at `{part}`: an assignment to the attribute .shape is not supported in a kernel: bind the new shape "
            "to a new name: y = x.reshape(...)"))
