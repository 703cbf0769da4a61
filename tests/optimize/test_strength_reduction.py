"""The fast text for NumPy: squares for powers, and no look at each element for a quotient by a number."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad import differentiate
from tests.harness.derivatives import check_derivatives

X = np.array([0.3, -1.2, 0.8, 2.0])


def cubes(x, y):
    y[:] = x ** 3 + x[::-1] ** 5 - x ** 2 + x ** 8 / 10 + x ** -3


def slopes(x, dx):
    return np.sum((x[1:] - x[:-1]) / dx * x[1:])


def linear(x, dx):
    return np.sum((x[1:] - x[:-1]) / dx)


def of_extremes(x, a, s):
    for i in range(2):
        t = x - np.max(x) * a[i, 0] + np.min(x)
        x[:] = t * np.max(np.abs(t)) / np.max(a)
    return np.sum(x) * np.min(a, axis=1)[0] + np.max(s) * np.min(a * a)


TABLE = np.array([[0.5, 1.5, -0.7], [1.1, 0.2, 0.4]])


@pytest.mark.parametrize(("kernel", "arguments", "wrt", "of"), [
    (of_extremes, (X, TABLE, np.array([[2.0]])), ("x", "a", "s"), ("return", "x")),
    (cubes, (X, np.zeros(4)), ("x",), ("y",)), (slopes, (X, 0.5), ("x", "dx"), ("return",))])
def test_gradients(kernel, arguments, wrt, of):
    check_derivatives(kernel, arguments, wrt, of)


def test_texts():
    text = differentiate(cubes, engine="numpy").adjoint_source(X, np.zeros(4), level="fast")
    assert "(x[::-1] ** 2) ** 2" in text and "** 4" not in text and "** 7" not in text and "x ** -3" in text
    text = differentiate(slopes, engine="numpy", wrt=("x",)).adjoint_source(X, 0.5, level="fast")
    assert "if abs(dx) > 0.0 else np.where" in " ".join(text.split())
    for kernel, arguments in ((cubes, (X, np.zeros(4))), (slopes, (X, 0.5))):
        text = differentiate(kernel, engine="numpy").adjoint_source(*arguments)
        assert "abs(" not in text and "** 2) ** 2" not in text


def test_extremes_gain_at_their_places():
    text = differentiate(of_extremes, engine="numpy").adjoint_source(X, TABLE, np.array([[2.0]]), level="fast")
    assert "x_bar[extreme_place(x, " in text and "a_bar[extreme_place(a, " in text
    for x in (np.array([1.0, 3.0, 3.0]), np.array([1.0, np.nan, np.nan])):
        found = s2sad.gradient(differentiate(highest, engine="numpy"))(x)
        assert np.array_equal(found, [0.0, 1.0, 0.0])       # the first of several


def highest(x):
    return np.max(x)


@pytest.mark.filterwarnings("ignore:divide by zero", "ignore:invalid value")
@pytest.mark.parametrize("dx", [0.0, np.nan])
def test_a_zero_seed_stays_zero(dx):
    found = s2sad.vjp(differentiate(linear, engine="numpy"), (X, dx), {"return": 0.0}, wrt="x")["x"]
    assert np.array_equal(found, np.zeros(4))
