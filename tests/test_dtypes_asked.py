"""Dtypes that are asked of arrays, and ranges where NumPy takes them for arrays of integers."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, gradient
from tests.derivatives import check_derivatives
from tests.engines import each

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


@pytest.mark.parametrize(("kernel", "engine"), each([converted, allocated, named, narrow, picked, lists]))
def test_dtypes_and_ranges(kernel, engine):
    check_derivatives(kernel, (X, M), ("x", "m"), ("return",), engine=engine)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_single_precision(engine):
    for kernel in (converted, allocated, named):
        check_derivatives(kernel, (X.astype("float32"), M.astype("float32")), ("x", "m"), ("return",), engine=engine)


def rounded(x):
    return np.linspace(-1.5, 1.5, 4, dtype=np.int64)[0] * x[0]


def changing(x):
    dt = x.dtype
    x = np.arange(3)
    return x.astype(dt).sum()


@pytest.mark.parametrize(("kernel", "message"), [
    (rounded, "no derivative rule for numpy.linspace with dtype="), (changing, "the type of 'dt' cannot be inferred")])
def test_what_is_refused(kernel, message):
    with pytest.raises(S2sadError) as refused:
        gradient(kernel)(X)
    assert message in str(refused.value)
