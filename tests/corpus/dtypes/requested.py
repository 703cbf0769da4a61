"""Dtypes that are asked of arrays, and ranges where NumPy takes them for arrays of integers."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X, M = np.array([0.3, 1.1, 0.7]), np.arange(1.0, 10.0).reshape(3, 3) / 7


def converted(x, m):
    mask = (x > 0.5).astype(x.dtype)
    return (mask * x).sum() + (np.arange(3).astype(m.dtype) * x).sum()


def allocated(x, m):
    a, b, c = np.zeros(3, dtype=x.dtype), np.array([1, 2, 3], dtype=x.dtype), np.linspace(0, 1, 3, dtype=x.dtype)
    d, e, f = np.full(3, 2.0, dtype=x.dtype), np.eye(3, dtype=x.dtype), np.arange(3, dtype=x.dtype)
    a[:] = x
    return (a * b * c * d * f).sum() + (e @ x).sum() + np.asarray(x, dtype=x.dtype) @ np.identity(3, m.dtype)[1]


def named(x, m):
    dt = x.dtype
    w = np.ones(3, dt)
    for i in range(3):
        w[i] = x[i] ** 2
    return (x.astype(dt) * w * np.arange(3).astype(dt)).sum()


def narrow(x, m):
    k = np.arange(x.size, dtype=np.int32)
    ones = np.eye(3, dtype=np.int32)
    return (k * x).sum() + x[k] @ m[k, k[::-1]] + (ones * m).sum() + (x * 3.0).astype(np.int32)[1] * x[0]


def picked(x, m):
    n = len(x)
    y = np.array([2, 0, 1])
    num = m @ m.T
    num[range(n), range(n)] = 0.0
    return np.sum(np.log(m[range(n), y])) + (num * num).sum() + m[range(1, n), y[1:]].sum()


def lists(x, m):
    places = list(range(x.size))
    s = x[places].sum() + (np.array(range(3)) * x).sum() + np.asarray(range(1, 4)) @ x
    for i in list(range(1, 3)):
        s += x[i] * i * places[i]
    return s


def rounded(x):
    return np.linspace(-1.5, 1.5, 4, dtype=np.int64)[0] * x[0]


def changing(x):
    dt = x.dtype
    x = np.arange(3)
    return x.astype(dt).sum()


def cases():
    for kernel in (converted, allocated, named, narrow, picked, lists):
        yield Case(kernel, (X, M), ("x", "m"))
    # single precision
    for kernel in (converted, allocated, named):
        yield Case(kernel, (X.astype("float32"), M.astype("float32")), ("x", "m"))
    for kernel, refused in (
            (rounded,
             "S301 at `np.linspace(-1.5, 1.5, 4, dtype=np.int64)`: no derivative rule for numpy.linspace with "
             "dtype=: write it with functions that have a rule, or give it one: s2sad.rule, s2sad.nondifferentiable"),
            (changing,
             "S203 at `dt = x.dtype`: the type of 'dt' cannot be inferred: write it with operations on numbers and "
             "arrays that are known")):
        yield Case(kernel, (X,), refused=refused)
