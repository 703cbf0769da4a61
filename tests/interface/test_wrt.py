"""What a gradient is with respect to: names, positions, and by default what the kernel's text takes for floats."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, differentiate, gradient, value_and_gradient, vjp

X = np.array([1.0, 2.0, 3.0])


def weighted(x, k):
    return k * np.sum(x * x)


def bounded(x, n):
    total = 0.0
    for i in range(n):
        total += x[i]
    return total


def chosen(x, scheme, verbose=False):
    if scheme == 2 and not verbose:
        return np.sum(x * x)
    return np.sum(x)


def chosen_deeper(x, scheme):
    return chosen(x, scheme)


def chosen_by_both(x, first, second):
    both = first and second
    return np.sum(x * x) if both else np.sum(x)


def or_else(x, scale):
    factor = scale or 1.0
    return factor * np.sum(x)


def and_then(x, scale):
    return (scale and 3.0) * np.sum(x)


def power(x, order=2):
    return np.sum(x ** order)


def annotated(x, k: int, c: float):
    return k * c * np.sum(x)


def masked(x, w=None):
    return np.sum(x) if w is None else np.sum(w * x)


def sized(x, n):
    m = 2 * n
    return np.sum(np.tile(x, m - 1)) + np.sum(x.reshape(n, -1))


def labelled(w, labels):
    total = 0.0
    for i in range(labels.size):
        if labels[i] == 1:
            total += w[i]
    return total


@dataclass
class Model:
    k: float
    n: int


def of_model(model, x, c):
    return model.k * c * np.sum(x[:model.n])


@pytest.mark.parametrize(("f", "args", "gives"), [
    (weighted, (X, 2), {"x": [4.0, 8.0, 12.0], "k": 14.0}),
    (weighted, (X, np.int32(2)), {"x": [4.0, 8.0, 12.0], "k": 14.0}),
    (weighted, (X, 2.0), {"x": [4.0, 8.0, 12.0], "k": 14.0}),
    (bounded, (X, 2), [1.0, 1.0, 0.0]),
    (chosen, (X, 2), [2.0, 4.0, 6.0]),
    (chosen, (X, 2.5, True), [1.0, 1.0, 1.0]),
    (chosen_deeper, (X, 2), [2.0, 4.0, 6.0]),
    (chosen_by_both, (X, True, 1), [2.0, 4.0, 6.0]),
    (or_else, (X, 2.0), {"x": [2.0, 2.0, 2.0], "scale": 6.0}),
    (and_then, (X, 2.0), {"x": [3.0, 3.0, 3.0], "scale": 0.0}),
    (power, (X,), [2.0, 4.0, 6.0]),
    (power, (X, 2.0), [2.0, 4.0, 6.0]),
    (annotated, (X, 2, 3), {"x": [6.0, 6.0, 6.0], "c": 12.0}),
    (annotated, (X, 2, 3.0), {"x": [6.0, 6.0, 6.0], "c": 12.0}),
    (masked, (X,), [1.0, 1.0, 1.0]),
    (masked, (X, X), {"x": [1.0, 2.0, 3.0], "w": [1.0, 2.0, 3.0]}),
    (sized, (X, 1), [2.0, 2.0, 2.0]),
    (labelled, (X, np.array([1, 0, 1])), {"w": [1.0, 0.0, 1.0]}),
    (labelled, (X, np.array([1.0, 0.0, 1.0])), {"w": [1.0, 0.0, 1.0], "labels": [0.0, 0.0, 0.0]}),
    (of_model, (Model(2.0, 2), X, 3), {"model": Model(9.0, 2), "x": [6.0, 6.0, 0.0], "c": 6.0}),
    (of_model, (Model(2.0, 2), X, 3.0), {"model": Model(9.0, 2), "x": [6.0, 6.0, 0.0], "c": 6.0}),
])
def test_by_default_what_the_text_takes_for_floats(f, args, gives):
    found = gradient(differentiate(f, engine="numpy"))(*args)
    if not isinstance(gives, dict):
        np.testing.assert_array_equal(found, gives)
        return
    assert list(found) == list(gives)
    for name, value in gives.items():
        if isinstance(value, Model):
            assert found[name] == value
        else:
            np.testing.assert_array_equal(found[name], value)


def test_an_integer_that_is_named_is_a_float_where_it_may_be():
    f = differentiate(power, engine="numpy")
    assert gradient(f, "order")(np.ones(2)) == gradient(f, "order")(np.ones(2), 2.0) == 0.0
    with pytest.raises(S2sadError) as caught:
        gradient(differentiate(bounded, engine="numpy"), "n")(X, 2)
    assert str(caught.value) == ("error[S401]: wrt names 'n', which is an integer\n"
                                 "  help: give a float (3.0, not 3) if it is a real quantity")


def test_positions_are_names():
    f = differentiate(weighted, wrt=1, engine="numpy")
    assert f.wrt == ("k",) and gradient(f)(X, 2.0) == 14.0
    f = differentiate(weighted, engine="numpy")
    np.testing.assert_array_equal(gradient(f, 0)(X, 2.0), gradient(f, "x")(X, 2.0))
    assert list(gradient(f, (1, "x"))(X, 2.0)) == ["x", "k"] and gradient(f, -1)(X, 2.0) == 14.0
    assert list(vjp(f, (X, 2.0), {"return": 1.0}, wrt=1)) == ["k"]


@pytest.mark.parametrize(("wrt", "says"), [
    (2, "error[S401]: wrt names the parameter at 2, and 'weighted' has 2\n  help: its parameters are x, k"),
    (1.5, "error[S401]: wrt holds a float\n"
          '  help: give names of parameters, or their positions: "x", 0, ("x", "y")'),
    (X, "error[S401]: wrt holds a ndarray\n"
        '  help: give names of parameters, or their positions: "x", 0, ("x", "y")'),
])
def test_what_is_neither_a_name_nor_a_position(wrt, says):
    with pytest.raises(S2sadError) as caught:
        gradient(weighted, wrt)
    assert str(caught.value) == says


def test_what_other_packages_call_it():
    with pytest.raises(TypeError) as caught:
        gradient(weighted, argnums=0)  # pyright: ignore[reportArgumentType]
    assert str(caught.value) == ("gradient() got an unexpected keyword argument 'argnums': write wrt: a name, "
                                 'wrt="x", a position, wrt=0, or several of them')
    for call in (value_and_gradient, differentiate):
        with pytest.raises(TypeError, match="unexpected keyword argument 'blub'$"):
            call(weighted, blub=0)  # pyright: ignore[reportArgumentType]
    with pytest.raises(AttributeError) as missing:
        getattr(s2sad, "elementwise_grad")  # noqa: B009
    assert str(missing.value) == (
        "module 's2sad' has no attribute 'elementwise_grad': write s2sad.gradient(f, wrt=\"x\")")
    with pytest.raises(AttributeError, match="no attribute 'blub'$"):
        getattr(s2sad, "blub")  # noqa: B009
    for name in ("grad_and_value", "jacrev", "hess", "vhp", "jit", "vmap", "custom_vjp", "stop_gradient"):
        with pytest.raises(AttributeError, match=f"no attribute '{name}': .{{20}}"):
            getattr(s2sad, name)


def test_positions_as_in_jax():
    same = gradient(weighted, wrt="x")(X, 2)
    np.testing.assert_array_equal(s2sad.grad(weighted)(X, 2), same)
    np.testing.assert_array_equal(s2sad.grad(weighted, argnums=-2)(X, 2), same)
    (one,) = s2sad.grad(weighted, argnums=(0,))(X, 2)
    np.testing.assert_array_equal(one, same)
    value, (first, _) = s2sad.value_and_grad(weighted, argnums=(0, 1))(X, 2.0)
    assert value == s2sad.value_and_grad(weighted)(X, 2)[0] == weighted(X, 2)
    np.testing.assert_array_equal(first, same)


def test_minimize_takes_a_value_and_a_gradient():
    optimize = pytest.importorskip("scipy.optimize")
    value, slope = value_and_gradient(weighted, wrt="x")(X, 2)
    assert type(value) is float and slope.dtype == np.float64 and slope.shape == X.shape
    for method in ("BFGS", "L-BFGS-B", "SLSQP"):
        found = optimize.minimize(value_and_gradient(weighted, wrt="x"), [1, 2, 3], jac=True, args=(2,), method=method)
        np.testing.assert_allclose(found.x, 0.0, atol=1e-6)
