"""Sums that begin with a number and go on as arrays."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.normalize.shape_guards import TRIPS
from tests.derivatives import check_derivatives
from tests.engines import said

ENGINES = ("numpy", "numba")


def modes(x, w, n):
    """Two sums in one loop, one of them nested; the bound is lost in the loop, and a counter is used again after it."""
    field, weight = 0.0, 0
    for k in range(n):
        n = w.shape[1]
        weight = weight + w[k] ** 2
        for j in range(n):
            field += w[k, j] * np.sin((k + 1) * x)
        x[k] *= field[0]
    for k in range(2):
        field = field * x[k]
    return np.sum(field ** 2) * np.sum(weight)


def backwards(x, w):
    """A sum in each trip of another loop; a matrix product; steps down."""
    for i in range(2):
        total = 0
        for k in range(2, -1, -2):
            total += w[k] @ w.T * x[i] + w[k, i]
        w[i] += total[:2] * 0.1
    s = 0.0
    for row in w:
        s = s + row * x[:2]
    return np.sum(s * s)


def smooth(u, taps):
    out = 0.0
    for k, tap in enumerate(taps):
        out += tap * u[k:u.size - 2 + k]
    return out


def in_a_helper(x, w):
    x[1:-1] = smooth(x, w[0, :2]) + smooth(x, w[:, 1])
    start = 1.0
    start += x[1:3]
    start *= start
    return np.sum(start)


CASES = [(modes, (2,), ("x", "return")), (backwards, (), ("w", "return")), (in_a_helper, (), ("x", "return"))]


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("kernel, rest, of", CASES, ids=lambda case: getattr(case, "__name__", ""))
def test_kernel(kernel, rest, of, engine):
    x = np.array([0.5, 0.8, 1.2, 0.9, 0.4])
    w = np.array([[0.3, 0.7], [1.1, 0.6], [0.2, 0.9]])
    check_derivatives(kernel, (x, w, *rest), ("x", "w"), of, engine)


def test_no_trip():
    gradient = s2sad.gradient(s2sad.differentiate(modes, engine="numpy"), wrt="x")
    with pytest.raises(s2sad.S2sadError) as caught:
        gradient(np.ones(3), np.ones((2, 2)), 0)
    assert said(caught.value) == TRIPS


def left_early(x, n):
    total = 0.0
    for k in range(n):
        total += k * x
        if total[0] > 1.0:
            break
    return np.sum(total)


def under_a_test(x, n):
    total = 0.0
    for k in range(n):
        if x[k] > 0.0:
            total += x
    return np.sum(total)


@pytest.mark.parametrize("kernel", (left_early, under_a_test))
def test_what_need_not_become_an_array(kernel):
    with pytest.raises(s2sad.S2sadError, match=r"'total' is bound to float64 and to float64\[:\]"):
        s2sad.gradient(kernel, wrt="x")(np.ones(3), 3)
