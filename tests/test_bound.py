"""Methods, partials and objects that are called, as kernels and within kernels."""
from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from s2sad.live_objects.unwrap import python_function
from tests.derivatives import check_derivatives

ENGINES = ("numpy", "numba")


class Base:
    exponent = 2

    def weight(self, k, scale=1.0):
        return self.weights[k] ** self.exponent * scale

    @classmethod
    def shifted(cls, x):
        return x + cls.exponent

    @staticmethod
    def bent(x):
        return x * x if x > 0.5 else 0.25 * x


class Model(Base):
    def __init__(self, weights, rate):
        self.weights, self.rate = weights, rate
        self.options = {"order": 3}

    def run(self, u, steps=2):
        for _ in range(steps):
            for k in range(u.size):
                u[k] += self.rate * self.weight(k, scale=0.5) * self.bent(u[k])
        return self.shifted(np.sum(u) ** self.options["order"])

    def __call__(self, u, out):
        for k in range(u.size):
            out[k] = self.rate * u[k] * self.weights[k]

    def keeps(self, u):
        self.weights[0] = u[0]
        return self.weights[0]


@dataclass
class Line:
    slope: float
    offset: float

    def __call__(self, x):
        return self.slope * x + self.offset


MODEL = Model(np.array([1.0, 0.5, 0.25]), 0.3)
LINE = Line(2.0, 0.5)


def through_objects(u):
    total = 0.0
    for k in range(u.size):
        total += LINE(u[k]) * MODEL.weight(k) + LINE.slope
    return total


def scaled(u, c, *, power=2):
    total = 0.0
    for k in range(u.size):
        total += c * u[k] ** power
    return total


cubes = functools.partial(scaled, power=3)


def by_a_partial(u):
    return cubes(u, 2.0) * u[0]


def values():
    return np.array([0.3, 0.6, 0.9])


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_bound_kernels(engine):
    check_derivatives(MODEL.run, (values(),), ("u",), ("u", "return"), engine)
    check_derivatives(MODEL, (values(), np.zeros(3)), ("u",), ("out",), engine)
    cubic = python_function(functools.partial(scaled, c=2.0, power=3))
    check_derivatives(cubic, (values(),), ("u",), ("return",), engine)
    check_derivatives(through_objects, (values(),), ("u",), ("return",), engine)
    check_derivatives(by_a_partial, (values(),), ("u",), ("return",), engine)


@pytest.mark.parametrize("engine", ENGINES)
def test_what_an_object_holds_now(engine):
    model = Model(np.array([1.0, 0.5, 0.25]), 0.3)
    function = s2sad.differentiate(model, wrt="u", engine=engine)
    seeds = {"out": np.ones(3)}
    for rate in (0.3, 0.7):
        model.rate = rate
        np.testing.assert_allclose(s2sad.vjp(function, (values(), np.zeros(3)), seeds)["u"], rate * model.weights)
    model.weights = np.array([3.0, 2.0, 1.0])
    np.testing.assert_allclose(s2sad.vjp(function, (values(), np.zeros(3)), seeds)["u"], 0.7 * model.weights)


def test_one_derivative_for_one_method():
    assert s2sad.differentiate(MODEL.run)._derivatives is s2sad.differentiate(MODEL.run)._derivatives
    other = Model(np.array([2.0, 0.5, 0.25]), 0.3)
    assert s2sad.differentiate(other.run)._derivatives is not s2sad.differentiate(MODEL.run)._derivatives
    assert s2sad.differentiate(other.run).primal(values()) != s2sad.differentiate(MODEL.run).primal(values())


def test_signatures_and_reports():
    tripled = functools.partial(scaled, c=3.0)
    function = s2sad.differentiate(tripled, engine="numpy")
    assert function(values()) == tripled(values()) == function.primal(values())
    assert "def scaled_adjoint(u, u_bar, power, result_bar):" in function.adjoint_source(values())
    assert s2sad.check(function, values())
    assert "scaled_adjoint" in str(s2sad.explain(function, values()))


def refusal(function, *args):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(function, engine="numpy"))(*args)
    return str(caught.value)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_object_is_not_written(engine):
    before = MODEL.weights.copy()
    gradient = s2sad.gradient(s2sad.differentiate(MODEL.keeps, engine=engine))(values())
    np.testing.assert_array_equal(gradient, [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(MODEL.weights, before)


@pytest.mark.parametrize("engine", ENGINES)
def test_parameters_by_keyword_only(engine):
    function, u = s2sad.differentiate(scaled, engine=engine), values()
    assert function.primal(u, 2.0) == pytest.approx(scaled(u, 2.0), rel=1e-15)
    assert function.primal(u, 2.0, power=3) == pytest.approx(scaled(u, 2.0, power=3), rel=1e-15)
    assert s2sad.check(function, u, 2.0)
    np.testing.assert_allclose(s2sad.gradient(function, "u")(u, 2.0, power=3), 6.0 * u ** 2, rtol=1e-14)


def test_what_is_refused():
    def doubled(u, c):
        c *= 2.0
        return np.sum(u) * c

    found = refusal(functools.partial(doubled, c=1.0), values())
    assert "error[S101]: 'c' was given already, and is assigned\n" in found
    assert "help: assign to another name, or give the argument with each call" in found
    assert refusal([].append, values()) == (
        "error[S101]: 'append' has no Python source: it is a builtin_function_or_method\n"
        "  help: give a function defined with def in a .py file, which may call it")
