"""Reductions of a number: NumPy takes it for an array without axes."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, differentiate, gradient
from tests.derivatives import check_derivatives
from tests.engines import each

X = np.array([0.3, 1.1, -0.7])


def twice(x):
    return np.sum(np.sum(x * x)) + np.max(np.max(x)) * np.amin(np.min(x, axis=0), axis=0)


def methods(x):
    s = x[0] * x[1]
    return x.var(axis=0).sum() + s.mean() * s.max() - s.min() * s.prod()


def averages(x):
    s = x[0] * x[2]
    return np.mean(s, axis=None) * np.median(s) * np.average(x[1]) + np.prod(s, keepdims=False)


def sizes(x):
    s = x[0] * x[2]
    return np.linalg.norm(s) + np.abs(np.linalg.norm(np.sum(x))) * np.linalg.norm(x[1])


def spreads(x):
    s = x[0] * x[1]
    return np.std(s) * x[0] + np.var(s, ddof=0) + np.exp(s.std()) * s


def integers(x):
    n = x.size
    return np.mean(n) * x[0] + np.sum(n) * x[1] + np.max(n // 2) * x[2]


def in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        s += np.sum(x[i] ** 2) * np.linalg.norm(s - x[i])
    return s


@pytest.mark.parametrize(("kernel", "engine"), each([twice, methods, averages, sizes, spreads, integers, in_a_loop]))
def test_reductions_of_numbers(kernel, engine):
    check_derivatives(kernel, (X,), ("x",), ("return",), engine=engine)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_single_precision_stays(engine):
    check_derivatives(sizes, (X.astype("float32"),), ("x",), ("return",), engine=engine)
    check_derivatives(averages, (X[[0, 1, 2]].astype("float32"),), ("x",), ("return",), engine=engine)


def of_one(a):
    return np.sum(a * a) + np.mean(a) + np.std(a) + np.linalg.norm(a)


def test_a_number_of_its_own():
    assert gradient(of_one)(1.5) == 5.0
    assert gradient(of_one)(-1.5) == -3.0
    assert np.isnan(differentiate(lambda a: np.std(a) + a).primal(np.inf))


def counted(x):
    return np.sum(x[0] > 0) * x[1]


def spread_of_a_sample(x):
    return np.std(x[0], ddof=1)


@pytest.mark.parametrize(("kernel", "message"), [
    (counted, "no derivative rule for numpy.sum of bool"), (spread_of_a_sample, "no derivative rule for numpy.std")])
def test_what_is_refused(kernel, message):
    with pytest.raises(S2sadError, match=r"error\[S301\]") as refused:
        s2sad.gradient(kernel)(X)
    assert message in str(refused.value)
