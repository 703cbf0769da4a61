"""Options that NumPy's functions take: each is followed, or refused by its name."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives
from tests.engines import each

X, Y = np.array([0.9, 0.31, 1.4, 0.55, 1.13]), np.array([0.7, 1.1, 0.8, 1.4, 1.3])
M = np.arange(1.0, 10.0).reshape(3, 3) / 5.0


def left_where_it_is(x, y, m):
    v = np.nan_to_num(x, copy=False)
    v[0] = y[0]
    w = np.nan_to_num(m[1], False, 2.0)
    w[0] *= y[1]
    np.nan_to_num(m[0], copy=False)
    y = np.nan_to_num(y[1:4], copy=False)
    y[0] += x[2]
    return np.sum(x ** 2) + np.sum(m ** 2) * np.sum(np.nan_to_num(y, copy=False))


def left_or_made(x, y, m):
    picked = np.nan_to_num(x[x > 0.6], copy=False)
    picked[0] = y[0]
    made = np.nan_to_num(x * y[0], copy=False)
    made[1] = y[1]
    cleaned(x)
    return np.sum(x ** 2) * np.sum(picked) + np.sum(made ** 2) + np.sum(m)


def cleaned(x):
    np.nan_to_num(x, copy=False, posinf=3.0)
    x[0] *= 2.0


@pytest.mark.parametrize(("kernel", "engine"), each([left_where_it_is, left_or_made]))
def test_derivatives(kernel, engine):
    check_derivatives(kernel, (X, Y, M), ("x", "y", "m"), ("return",), engine)


def by_a_flag(x, y):
    v = np.nan_to_num(x, copy=y[0] > 0.0)
    v[0] = y[0]
    return np.sum(x ** 2)


@pytest.mark.parametrize(("kernel", "text"), [
    (by_a_flag, "no derivative rule for numpy.nan_to_num with copy= that is not written out")])
def test_what_is_refused(kernel, text):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kernel, wrt="x")(X, Y)
    assert text in str(caught.value), str(caught.value)
