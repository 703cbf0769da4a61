"""Exponentials in loops that run in vectors are the runtime's; all of a function's calls, or none."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import differentiate
from tests.harness.derivatives import check_derivatives

X = np.array([0.3, -1.2, 2.5, 0.0, -0.4])


def layer(w, x, y):
    for i in range(y.size):
        y[i] = np.tanh(w[i] * x[i]) + np.sinh(x[i])
    for i in range(y.size):
        y[i] = y[i] * np.exp(-w[i] * w[i]) + np.expm1(0.1 * x[i])


def recurrence(x):
    t = 0.0
    for i in range(x.size):
        t = np.exp(0.1 * t) * x[i]
    return t


def branched(x, y):
    for i in range(x.size):
        if np.exp(x[i]) > 1.0:
            y[i] = np.exp(x[i]) ** 2


def beside(x, y):
    """One loop runs in vectors, the other does not: both call the same exponential."""
    for i in range(x.size):
        y[i] = np.exp(x[i])
    t = 0.0
    for i in range(x.size):
        t = np.exp(0.1 * t) * x[i]
    y[0] += t


def scattered(x, k, y):
    for i in range(x.size):
        y[i] += np.tanh(x[k[i]])


def narrow(x, y):
    for i in range(x.size):
        y[i] = np.exp(x[i])


def powers(x, y):
    for i in range(x.size):
        y[i] = np.exp(x[i]) * abs(x[i]) ** 1.5


K = np.array([0, 2, 2, 1, 0])
CASES = [(layer, (0.5 * X, X, np.zeros(5)), True), (recurrence, (X,), False), (branched, (X, np.zeros(5)), False),
         (beside, (X, np.zeros(5)), False), (scattered, (X, K, np.zeros(5)), False),
         (narrow, (X.astype(np.float32), np.zeros(5, np.float32)), False), (powers, (X, np.zeros(5)), False)]


@pytest.mark.parametrize(("kernel", "arguments", "replaced"), CASES, ids=[k.__name__ for k, _, _ in CASES])
def test_where_they_are_replaced(kernel, arguments, replaced):
    text = differentiate(kernel, engine="numba").adjoint_source(*arguments, level="fast")
    head = next((line for line in text.splitlines() if line.startswith("from s2sad.runtime import")), "")
    assert any(f in head.replace(",", " ").split() for f in ("exp", "tanh", "cosh")) == replaced


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_gradients(engine):
    check_derivatives(layer, (0.5 * X, X, np.zeros(5)), ("w", "x"), ("y",), engine=engine)
