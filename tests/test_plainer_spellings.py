"""Spellings that are read as plainer ones, and what is said of those that are not."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives

X, M = np.array([0.3, 0.7, 1.1, 2.5, 0.9]), np.array([[0.3, 0.7, 1.1], [0.5, 2.5, 0.9]])


def product(d):
    return d["a"] * np.sum(d["b"])


def several(x, m):
    a, b, *_ = x
    *_, c, d = x
    b, *_, a = x
    rows, *_ = m.shape
    total = 0.0
    for i, j in np.ndindex(*m.shape):
        total += m[i, j] * x[i] / rows
    made = dict(a=x[0], b=x[1:])  # noqa: C408
    squares = product(dict(a=x[1], b=m * m))  # noqa: C408
    return total * a * b + c * d * made["a"] * np.sum(made["b"]) + squares


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_derivatives(engine):
    check_derivatives(several, (X, M), ("x", "m"), ("return",), engine)


def rest_that_is_read(x, m):
    first, *rest = x
    return first * np.sum(rest)


def one_index(x, m):
    total = 0.0
    for place, value in np.ndenumerate(m):
        total += value * x[place[0]]
    return total


def names_that_swap(x, m):
    w, v = 2.0 * x, 3.0 * x
    for k in range(4):
        v[1:] = x[:-1] * 0.5
        x, v = v, x
        if k > 1:
            x, w = w, x
    return np.sum(x * x)


@pytest.mark.parametrize("kernel, texts", [
    (rest_that_is_read, ("a target with a star is not supported in a kernel",
                         "bind the others one by one, and take the rest by a slice: rest = x[1:]")),
    (one_index, ("np.ndenumerate over an unknown number of axes, or of something that has no name",
                 "name the indices: for (i, j), v in np.ndenumerate(x)"))])
def test_what_is_said(kernel, texts):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kernel, wrt="x")(X, M)
    assert all(text in str(caught.value) for text in texts), str(caught.value)


def test_names_are_the_users():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(names_that_swap, wrt="x")(X, M)
    assert "_own" not in str(caught.value)
