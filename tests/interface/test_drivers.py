"""Gradients, products with seeds and with tangents: values, what they leave alone, refusals with their texts."""
from __future__ import annotations

import warnings

import numpy as np
import pytest

import s2sad
from s2sad import S2sadWarning, gradient, jvp, make_zero, value_and_gradient, vjp
from s2sad.dispatch.memory_reuse import CallCopies
from tests.interface import kernels
from tests.harness.refusals import refused

pytestmark = pytest.mark.usefixtures("fresh", "apart")


def test_gradients_change_nothing(made):
    f = made("norm")
    u = np.array([1.0, 2.0])
    u.flags.writeable = False
    assert gradient(f, "u")(u).tolist() == [2.0, 4.0]
    value, both = value_and_gradient(f)(u, c=2)
    assert value == 10.0 and both["u"].tolist() == [4.0, 8.0] and both["c"] == 5.0
    scale = made("scale")
    u = np.array([1.0, 2.0])
    for _ in range(2):
        found = vjp(scale, (u, 3.0), {"u": np.ones(2)})
        assert found["u"].tolist() == [3.0, 3.0] and found["c"] == 3.0
        assert jvp(scale, (u, 3.0), {"c": 1.0}, of="u")["u"].tolist() == [1.0, 2.0]
        assert u.tolist() == [1.0, 2.0]


def test_scipy_takes_value_and_gradient(made):
    optimize = pytest.importorskip("scipy.optimize")
    found = optimize.minimize(value_and_gradient(made("norm"), "u"), np.array([1.0, 2.0]), jac=True)
    assert np.allclose(found.x, 0.0, atol=1e-6)


def test_a_function_that_raises_midway(made):
    f = made("guarded")
    u = np.array([1.0, 2.0])
    with pytest.raises(AssertionError):
        vjp(f, (u, 3.0), {"return": 1.0})
    assert u.tolist() == [1.0, 2.0]
    assert vjp(f, (u, 9.0), {"return": 1.0}, wrt="u")["u"].tolist() == [2.0, 0.0]
    with pytest.raises(AssertionError):
        gradient(f, "u")(u, 3.0)
    assert u.tolist() == [1.0, 2.0]


def test_drivers_refuse():
    u = np.ones(2)
    refused("error[S401]: wrt names 'v', which is no parameter of 'norm'\n  help: its parameters are u, c",
            gradient(kernels.norm, "v"), u)
    refused("error[S401]: wrt names 'n', which is an integer\n"
            "  help: give a float (3.0, not 3) if it is a real quantity", vjp, kernels.pair, (1.0, 3),
            {"return": (1.0, None, 1.0)}, "n")
    refused("error[S401]: 'n' is no output of 'pair', which does not write it\n  help: its outputs are return",
            vjp, kernels.pair, (1.0, 3), {"n": 1.0})
    refused("error[S401]: 'q' is no output of 'scale'\n  help: its outputs are u",
            vjp, kernels.scale, (u, 1.0), {"q": u})
    refused("error[S401]: 'scale' returns no float\n  help: its outputs are u",
            vjp, kernels.scale, (u, 1.0), {"return": 1.0})
    refused("error[S403]: no seed was given for 'scale'\n  help: give a dict by output name, as {\"return\": 1.0}",
            vjp, kernels.scale, (u, 1.0), {})
    refused("error[S403]: the seed of 'u' is an array of float64 of shape (3,), its output one of float64 of shape "
            "(2,)\n  help: give an array of float64 of shape (2,)", vjp, kernels.scale, (u, 1.0), {"u": np.ones(3)})
    refused("error[S403]: the seed of 'u' is of type float, its output is an array\n"
            "  help: give an array of float64 of shape (2,)", vjp, kernels.scale, (u, 1.0), {"u": 1.0})
    refused("error[S403]: the seed of 'return' is of type ndarray, not a float\n  help: give a float",
            vjp, kernels.norm, (u,), {"return": u})
    refused("error[S401]: a gradient needs a function that returns one float; 'scale' returns nothing\n"
            "  help: use s2sad.vjp, which takes a seed for each output", gradient(kernels.scale), u, 1.0)
    refused("error[S101]: 'len' has no Python source: it is a builtin_function_or_method\n"
            "  help: give a function defined with def in a .py file, which may call it", gradient, len)
    with pytest.raises(TypeError, match=r"norm\(\) missing 1 required argument: 'u'"):
        gradient(kernels.norm)()


def test_an_argument_without_influence_warns(made):
    with pytest.warns(S2sadWarning, match="no output asked for of 'unused' depends on 't': its gradient is zero"):
        assert gradient(made("unused"), "t")(3.0, 4.0) == 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert gradient(made("unused"), "x")(3.0, 4.0) == 2.0


def test_make_zero():
    zero = make_zero({"a": np.ones((2, 2), np.float32), "b": (1.5, 3, None)})
    assert zero["a"].dtype == np.float32 and not zero["a"].any() and zero["b"] == (0.0, 3, None)


def test_public_names():
    for name in s2sad.__all__:
        assert getattr(s2sad, name).__doc__


def contracted(m):
    return np.tensordot(m, m, axes=([0, 1], [0, 1]))


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_the_seed_of_a_number_may_be_an_array_without_axes(engine):
    m = np.arange(6.0).reshape(2, 3)
    found = s2sad.vjp(s2sad.differentiate(contracted, engine=engine), (m,), {"return": np.array(2.0)})
    np.testing.assert_allclose(found["m"], 4.0 * m)


def only_written(du, u):
    for i in range(u.size):
        du[i] = u[i] ** 2


def read_as_well(du, u):
    for i in range(u.size):
        du[i] = u[i] * du[i]


def written_again(du, u):
    for i in range(u.size):
        du[i] = u[i] * du[i]
    for i in range(u.size):
        du[i] = du[i] * du[i]


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("kernel", "copied", "expected"), [
    (only_written, [], [6.0, 8.0]), (read_as_well, [], [1.0, 2.0]), (written_again, [("value", 0)], [6.0, 32.0])])
def test_what_the_adjoint_does_not_write_is_not_copied(kernel, copied, expected, engine, monkeypatch):
    made, before = [], CallCopies.of
    monkeypatch.setattr(CallCopies, "of", lambda self, place, a: made.append(place) or before(self, place, a))
    du, u = np.array([1.0, 2.0]), np.array([3.0, 4.0])
    found = vjp(s2sad.differentiate(kernel, engine=engine), (du, u), {"du": np.ones(2)}, wrt="u")["u"]
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(du, [1.0, 2.0])
    assert [place for place in made if place[0] == "value"] == copied
