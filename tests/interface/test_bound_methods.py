"""Methods, partials and objects that are called, as kernels and within kernels."""
from __future__ import annotations

import functools

import numpy as np
import pytest

import s2sad
from tests.corpus.calls.bound_methods import MODEL, Model, scaled, values

ENGINES = ("numpy", "numba")


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
