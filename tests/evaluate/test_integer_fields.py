"""An integer field stays one where what is assigned to it is an integer; else it is what is assigned."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from tests.harness.engines import each, running


@dataclass
class State:
    k: int
    d: int
    v: float
    size: float = 2.5

    def turn(self):
        self.k = (self.k + 1) % 3
        self.d = -self.d


def added_in_a_loop(s, x):
    t = 0.0
    for i in range(3):
        s.k += i
        t += x[s.k % 3] * s.v
    return t


def turned(s, x):
    t = 0.0
    for i in range(4):
        s.k = (s.k + 1) % 3
        s.d = -s.d
        t += x[s.k] * s.v * s.d * (i + 1)
    return t


def by_a_method(s, x):
    t = 0.0
    for i in range(4):
        s.turn()
        t += x[s.k] * s.v * s.d * (i + 1)
    return t


def of_counters_and_sizes(s, x):
    t = 0.0
    n = 2
    for i, v in enumerate(x):
        s.k = max(i, s.k) + n - 1
        s.d = len(x) * s.k // 2
        s.k -= 1
        t += x[s.k % 3] * s.v * s.d * v
    s.k = x.shape[0]
    s.d += x.size + int(s.v)
    return t * s.d * s.k


EVERY = (added_in_a_loop, turned, by_a_method, of_counters_and_sizes)


@pytest.mark.parametrize(("kernel", "engine"), each(EVERY))
def test_fields_of_integers_are_assigned_integers(kernel, engine):
    x = np.array([2.0, 3.0, 4.0])
    with running(engine) as name:
        value, found = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=name), wrt="x")(State(0, 1, 1.5), x)
        state = s2sad.gradient(s2sad.differentiate(kernel, engine=name), wrt="s")(State(0, 1, 1.5), x)

    def at(h):
        return kernel(State(0, 1, 1.5), x + h)
    assert value == pytest.approx(at(0.0))
    assert found == pytest.approx([(at(h) - at(-h)) / 2e-5 for h in 1e-5 * np.eye(3)], rel=1e-6)
    assert state.v == pytest.approx((kernel(State(0, 1, 1.50001), x) - kernel(State(0, 1, 1.49999), x)) / 2e-5)


def a_float_field(s, x):
    s.k = s.v
    return x[0] * s.k


def a_quotient(s, x):
    s.k = s.k / 2
    return x[0] * s.k


def a_counter_that_was_a_float(s, x):
    i = s.v
    for i in range(2):
        s.k = i
    s.d = i
    return x[0] * s.k


def a_field_called_size(s, x):
    i = s.size
    s.k = i
    return x[0] * s.k


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [a_float_field, a_quotient, a_counter_that_was_a_float, a_field_called_size],
                         ids=lambda k: k.__name__)
def test_a_field_that_becomes_another_number(kernel, engine):
    state, x = State(1, 1, 0.5), np.array([2.0, 3.0, 4.0])
    with running(engine) as name:
        f = s2sad.differentiate(kernel, engine=name)
        found, by_state = s2sad.gradient(f, "x")(state, x), s2sad.gradient(f, "s")(state, x)
    assert state == State(1, 1, 0.5)
    assert found == pytest.approx(np.array([kernel(State(1, 1, 0.5), d) for d in np.eye(3)]))
    assert by_state.v == pytest.approx((kernel(State(1, 1, 0.501), x) - kernel(State(1, 1, 0.499), x)) / 2e-3, rel=1e-9)
    assert by_state.size == pytest.approx(
        (kernel(State(1, 1, 0.5, 2.501), x) - kernel(State(1, 1, 0.5, 2.499), x)) / 2e-3, rel=1e-9)
