"""What decides a choice is recorded in place of what competes, and decides alike at ties, for nan, in users' rules."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad

ENGINES = ("numpy", "numba")


def smallest(x, y):
    for i in range(x.size):
        x[i] = np.minimum(x[i], y[i])
        y[i] = 3.0 * x[i]


@pytest.mark.parametrize("engine", ENGINES)
def test_ties_and_nan_decide_as_they_do_in_the_rule(engine):
    x, y = np.array([1.0, 2.0, 2.0, np.nan, 1.0]), np.array([2.0, 1.0, 2.0, 1.0, np.nan])
    derived = s2sad.differentiate(smallest, wrt=("x", "y"), of=("x",), engine=engine)
    gradients = s2sad.vjp(derived, (x, y), {"x": np.ones(5)})
    np.testing.assert_array_equal(gradients["x"], [1.0, 0.0, 1.0, 1.0, 1.0])
    np.testing.assert_array_equal(gradients["y"], [0.0, 1.0, 0.0, 0.0, 0.0])


def smaller_and_smaller(x, y):
    for _ in range(2):
        for i in range(x.size):
            x[i] = np.minimum(x[i], y[i])
            y[i] = 0.5 * x[i]


def test_a_byte_is_recorded_where_the_operands_are_lost():
    text = " ".join(s2sad.differentiate(smaller_and_smaller).adjoint_source(np.ones(3), np.ones(3)).split())
    assert "taken_stack: which way `x[i] = np.minimum(x[i], y[i])` went, len(range(2)) * x.size bytes" in text
    assert "x_stack" not in text and "y_stack" not in text


def kept(x, y, z):
    for i in range(x.size):
        z[i] += np.maximum(x[i], y[i])


def test_nothing_is_recorded_where_the_operands_are_at_hand():
    text = s2sad.differentiate(kept, of=("z",)).adjoint_source(np.ones(3), np.ones(3), np.ones(3))
    assert "It records nothing." in text


@s2sad.rule(x="numpy.where(y > 0.0, 2.0, 0.0)")
def ramp(x):
    return 2.0 * x if x > 0.0 else 0.0


def ramps(x):
    for i in range(x.size):
        x[i] = ramp(x[i] - 0.5)


def test_a_users_rule_may_ask_its_result():
    x = np.array([1.0, 0.25, 0.75])
    gradients = s2sad.vjp(s2sad.differentiate(ramps, of=("x",), engine="numpy"), (x,), {"x": np.ones(3)})
    np.testing.assert_array_equal(gradients["x"], [2.0, 0.0, 2.0])
