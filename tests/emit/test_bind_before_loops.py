"""What an iteration reads of the one before, above where it is bound: Numba compiles it."""
# ruff: noqa: F821, F841
from __future__ import annotations

import numpy as np
import pytest

from tests.harness.derivatives import check_derivatives

X = np.array([0.9, 0.31, 1.4])


def index_of_the_iteration_before(x):
    for i in range(3):
        if i > 1:
            x[i] *= 2.0 * x[m]
        m = i


def in_an_inner_loop(x):
    total = 0.0
    for i in range(2):
        for j in range(3):
            if j > 0:
                total += last * x[i] * big
            last, big = x[j] ** 2, x[j] > 0.5
    return total


def added_before_it_is_bound(x):
    i = 0
    while i < 3:
        if i > 0:
            x[i] += m
            m += x[i] * i
        if i == 0:
            m = x[i] * 2.0
        i += 1


def numbers(a):
    i, t = 0, 0.0
    while i < 3:
        if i > 1:
            t = t + m * a
        m = a * 2.0
        i = i + 1
    return t


def calls(x):
    s = 0.0
    for i in range(3):
        s += numbers(x[i]) * x[i]
    return s


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("kernel", "given", "of"), [
    (index_of_the_iteration_before, X, "x"), (in_an_inner_loop, X, "return"), (added_before_it_is_bound, X, "x"),
    (numbers, 0.7, "return"), (calls, X, "return")])
def test_derivatives(kernel, given, of, engine):
    check_derivatives(kernel, (given,), (kernel.__code__.co_varnames[0],), (of,), engine)
