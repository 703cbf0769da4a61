"""Indices that floats steer: a call that was looked at says nothing of one with the same integers and other floats."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad

pytest.importorskip("numba")

K = np.array([0, 1, 2, 3, 4, 5])
CALM, WILD = np.array([0.13, 0.2, 0.3, 0.4, 0.1, 0.2]), np.array([0.9, 0.8, 0.7, 0.95, 0.9, 0.6])


def by_a_count(x, k):
    j = 0
    for i in range(len(k)):
        if x[i] > 0.5:
            j += 3
    return x[k[j]] ** 2


def by_a_conversion(x, k):
    return x[int(x[0] * 10)] * x[k[0]]


def _picked(u):
    if u > 0.5:
        return 7
    return 1


def by_a_helper(x, k):
    return x[_picked(x[0])] * x[k[0]]


def by_flags(x, k):
    b, j, y = x > 0.5, 0, np.zeros(5)
    for i in range(len(x)):
        j = j + 2 * b[i]
    y[j] = x[0]
    return np.sum(y * x[:5]) + k[0]


def by_a_list(x, k):
    us = []
    for i in range(len(x)):
        if x[i] < 0.5:
            us.append(i)
    return x[us[1] + k[0]] ** 2


def by_what_a_mask_leaves(x, k):
    return x[x < 0.5][1 + k[0]] ** 2


@pytest.mark.parametrize("kernel", [
    by_a_count, by_a_conversion, by_a_helper, by_flags, by_a_list, by_what_a_mask_leaves])
def test_other_floats_are_looked_at(kernel):
    f = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine="numba"), "x")
    for _ in range(2):
        value, gradient = f(CALM, K)
        assert value == pytest.approx(kernel(CALM, K), rel=1e-15)
        slope = [(kernel(CALM + h, K) - kernel(CALM - h, K)) / 2e-6 for h in 1e-6 * np.eye(6)]
        np.testing.assert_allclose(gradient, slope, rtol=1e-6, atol=1e-9)
        with pytest.raises(IndexError):
            kernel(WILD, K)
        held = WILD.copy()
        with pytest.raises(IndexError):
            f(held, K)
        np.testing.assert_array_equal(held, WILD)
