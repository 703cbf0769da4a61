"""Derivatives of functions that are made where they are called, against the same kernels with those written by hand.

Python derives such a function anew at each call, so that differences of these kernels would take minutes.
"""
from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running

X, K = np.array([0.2, 0.7, 0.4]), 1.3


def cubes(x, k):
    return np.sum(x ** 3) * k


class Well:
    """A potential as an object."""

    def __init__(self, depth):
        self.depth = depth

    def value(self, x):
        return self.depth * np.sum(np.cos(x) * x)

    def pull(self, x):
        return -s2sad.gradient(self.value)(x)


def of_a_lambda(x, k):
    g = s2sad.gradient(lambda y: np.sum(y ** 3) * k)(x)
    return np.sum(g * x)


def of_a_closure(x, k):
    def cost(w):
        return np.sum((w - x) ** 2 * k) + np.sum(w ** 4)
    w = np.ones_like(x)
    for _ in range(2):
        w = w - 0.05 * s2sad.gradient(cost)(w)
    return np.sum(w ** 2)


def of_a_partial(x, k):
    return np.sum(s2sad.gradient(partial(cubes, k=k))(x) ** 2)


def of_an_object(x, k):
    well = Well(k)
    x = x + 0.1 * well.pull(x)
    return np.sum(x * x)


# -- by hand -----------------------------------------------------------------------------------------------------------
def lambda_by_hand(x, k):
    return np.sum(3.0 * x ** 2 * k * x)


def closure_by_hand(x, k):
    w = np.ones_like(x)
    for _ in range(2):
        w = w - 0.05 * (2.0 * (w - x) * k + 4.0 * w ** 3)
    return np.sum(w ** 2)


def partial_by_hand(x, k):
    return np.sum((3.0 * x ** 2 * k) ** 2)


def object_by_hand(x, k):
    x = x - 0.1 * k * (np.cos(x) - x * np.sin(x))
    return np.sum(x * x)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("nested", "by_hand"), [
    (of_a_lambda, lambda_by_hand), (of_a_closure, closure_by_hand), (of_a_partial, partial_by_hand),
    (of_an_object, object_by_hand)])
def test_functions_that_are_made_where_they_are_called(nested, by_hand, engine):
    with running(engine) as run_under:
        value, found = s2sad.value_and_gradient(s2sad.differentiate(nested, engine=run_under), wrt=("x", "k"))(X, K)
        same, wanted = s2sad.value_and_gradient(s2sad.differentiate(by_hand, engine=run_under), wrt=("x", "k"))(X, K)
        tangent = s2sad.jvp(s2sad.differentiate(nested, engine=run_under), (X, K), {"x": X ** 2, "k": 1.0})["return"]
    assert value == pytest.approx(same, rel=1e-14)
    np.testing.assert_allclose(found["x"], wanted["x"], rtol=1e-13)
    assert found["k"] == pytest.approx(wanted["k"], rel=1e-13)
    assert tangent == pytest.approx(np.dot(wanted["x"], X ** 2) + wanted["k"], rel=1e-13)


def triples(x):
    return np.array([x[0] * x[1], x[1] * x[1], x[0]])


def of_singles(x, k):
    return k * s2sad.jacobian(triples)(x)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_jacobians_of_singles_are_singles(engine):
    x = np.array([0.3, 0.7], np.float32)
    with running(engine) as run_under:
        f = s2sad.differentiate(of_singles, engine=run_under)
        found = s2sad.jvp(f, (x, np.float32(2.0)), {"x": np.array([1.0, 0.5], np.float32)})["return"]
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, np.array([[1.0, 2.0], [0.0, 2.0], [0.0, 0.0]], np.float32))
