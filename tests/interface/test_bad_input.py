"""Input that is odd or wrong, under both engines: exact messages, no hang, the primal's own arithmetic."""
from __future__ import annotations

import math

import numpy as np
import pytest

from s2sad import Differentiated, S2sadError, S2sadWarning, gradient, jvp, vjp
from tests.harness.refusals import refused
from tests.interface import kernels


def mean(u):
    total = 0.0
    for i in range(u.size):
        total += u[i] * u[i]
    return total / max(u.size, 1)


def root(a):
    guess = 1.0 + a / 3.0
    while abs(guess * guess * guess - a) > 1e-9:
        guess = guess - (guess * guess * guess - a) / (3.0 * guess * guess)
    return guess


def first(u):
    return u[0] * u[0]


@pytest.fixture(autouse=True)
def cache(monkeypatch, tmp_path_factory):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path_factory.getbasetemp() / "modules"))


@pytest.fixture(params=["numpy", "numba"])
def made(request):
    if request.param == "numba":
        pytest.importorskip("numba")
    return lambda f: Differentiated(f, engine=request.param)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_nan_and_infinity_stay_in_their_cell(made, odd):
    found = gradient(made(mean))(np.array([1.0, odd, 3.0]))
    np.testing.assert_array_equal(found, 2.0 * np.array([1.0, odd, 3.0]) / 3.0)
    assert isinstance(gradient(made(root))(odd), float)


def test_nothing_to_do(made):
    assert gradient(made(mean))(np.zeros(0)).shape == (0,)
    assert gradient(made(mean))(np.array([3.0])).tolist() == [6.0]
    found = vjp(made(kernels.scale), (np.zeros(0), 2.0), {"u": np.zeros(0)})
    assert found["u"].shape == (0,) and found["c"] == 0.0
    assert gradient(made(kernels.power))(2.0, 0) == 0.0
    with pytest.raises(IndexError):
        gradient(made(first))(np.zeros(0))


BASE = np.arange(12.0).reshape(3, 4)


@pytest.mark.parametrize("u", [BASE[:, 1], BASE[::-1, 1], BASE.T[1], np.asfortranarray(BASE)[1], BASE[1, ::-2]])
def test_layouts_of_memory(made, u):
    before = u.copy()
    np.testing.assert_allclose(gradient(made(mean))(u), 2.0 * before / u.size, rtol=1e-15)
    found = vjp(made(kernels.scale), (u, 3.0), {"u": np.ones(u.shape)})
    assert found["u"].tolist() == [3.0] * u.size and found["c"] == before.sum() and (u == before).all()


def test_read_only(made):
    u = np.array([1.0, 2.0])
    u.flags.writeable = False
    assert gradient(made(mean))(u).tolist() == [1.0, 2.0]
    assert vjp(made(kernels.scale), (u, 3.0), {"u": np.ones(2)})["u"].tolist() == [3.0, 3.0]
    refused("error[S405]: the argument 'u' is read-only, and the function writes it\n  help: pass a copy of it",
            made(kernels.scale).adjoint, u, np.ones(2), 3.0)


def test_integers_where_floats_are_needed(made):
    whole = np.array([1, 2])
    refused("error[S401]: 'mean' was given no float to differentiate with respect to\n"
            "  note: 'u' is an array of int64\n  help: pass u.astype(float) if it holds real quantities",
            gradient(made(mean)), whole)
    refused("error[S401]: 'root' was given no float to differentiate with respect to\n  note: 'a' is an integer\n"
            "  help: give a float (3.0, not 3) if it is a real quantity", vjp, made(root), (2,), {"return": 1.0})
    refused("error[S401]: wrt names 'u', which is an array of int64\n"
            "  help: pass u.astype(float) if it holds real quantities", gradient(made(kernels.norm), "u"), whole)


def test_one_array_twice(made):
    u = np.array([1.0, 2.0])
    found = vjp(made(kernels.dot), (u, u), {"return": 1.0})
    assert found["x"].tolist() == found["y"].tolist() == [1.0, 2.0]
    text = ("error[S404]: the arguments 'du' and 'u' share memory, and 'du' is written\n"
            "  help: pass a copy of one of them")
    refused(text, vjp, made(kernels.square), (u, u, 2), {"du": np.ones(2)})
    refused(text, made(kernels.square).primal, u, u, 2)
    assert u.tolist() == [1.0, 2.0]


def test_an_index_out_of_bounds_writes_nothing(made):
    memory = np.zeros(3)
    with pytest.raises(IndexError):
        made(kernels.square).primal(memory[:1], np.ones(3), 3)
    assert memory[1:].tolist() == [0.0, 0.0]


def test_arity_and_names(made):
    u = np.ones(2)
    with pytest.raises(TypeError, match=r"^norm\(\) takes 2 arguments but 3 were given$"):
        vjp(made(kernels.norm), (u, 1.0, 2.0), {"return": 1.0})
    with pytest.raises(TypeError, match=r"^norm\(\) got an unexpected keyword argument 'd'$"):
        gradient(made(kernels.norm))(u, d=1.0)
    refused("error[S401]: wrt names 'v', which is no parameter of 'norm'\n  help: its parameters are u, c",
            vjp, made(kernels.norm), (u, 1.0), {"return": 1.0}, "v")


def test_containers_that_are_none():
    u = np.ones(2)
    refused("error[S405]: args is of type ndarray\n  help: give a tuple of the function's arguments, as (u,)",
            vjp, kernels.norm, u, {"return": 1.0})
    refused("error[S403]: seeds is of type float\n  help: give a dict by output name", vjp, kernels.norm, (u,), 1.0)
    refused("error[S403]: tangents is of type float\n  help: give a dict by argument name",
            jvp, kernels.norm, (u,), 1.0)


def test_a_zero_gradient_warns_where_it_was_asked_for(made, recwarn):
    assert gradient(made(kernels.unused))(3.0, 4.0) == {"x": 2.0, "t": 0.0}
    assert not [w for w in recwarn.list if w.category is S2sadWarning]
    with pytest.warns(S2sadWarning) as caught:
        assert gradient(made(kernels.unused), "t")(3.0, 4.0) == 0.0
    assert str(caught[0].message) == "no output asked for of 'unused' depends on 't': its gradient is zero"
    assert caught[0].filename == __file__


def test_functions_without_source():
    space = {}
    exec("def made_up(u):\n    return u * u\n", space)
    refused("error[S101]: the source of 'made_up' cannot be had: it was defined in <string>, not in a file\n"
            "  help: write the function to a .py file and import it from there", gradient(space["made_up"]), 1.0)
    refused("error[S101]: 'len' has no Python source: it is a builtin_function_or_method\n"
            "  help: give a function defined with def in a .py file, which may call it", gradient, len)
    refused("error[S101]: a function is needed, not an int\n  help: give a function defined with def in a .py file",
            gradient, 3)


def half_precision(x):
    z = np.zeros(3, dtype=np.float16)
    z[:] = x
    return np.sum(z * z)


def of_a_name(x, kind):
    z = np.zeros(3, kind)
    z[:] = x
    return np.sum(z * z)


@pytest.mark.parametrize("kernel, arguments", [(half_precision, (np.ones(3),)), (of_a_name, (np.ones(3), "f2"))])
def test_a_dtype_that_kernels_do_not_have(kernel, arguments):
    with pytest.raises(S2sadError, match="the type of 'z' cannot be inferred"):
        gradient(kernel, wrt="x")(*arguments)


def short_names(x):
    z = np.zeros(3, dtype="f4")
    w = np.zeros(3, np.double)
    z[:] = x
    w[:] = x
    return np.sum(z * w)


def test_short_names_of_dtypes():
    text = Differentiated(short_names, engine="numpy").adjoint_source(np.ones(3))
    assert "z = np.zeros(3, np.float32)" in text and "w = np.zeros(3)" in text


def product(a, x):
    return np.sum(a @ x)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_factors_that_do_not_fit(engine):
    """The derivative does not need the product, which would have told."""
    function = Differentiated(product, wrt="x", engine=engine)
    assert vjp(function, (np.ones((2, 3)), np.ones(3)), {"return": 1.0})["x"].tolist() == [2.0, 2.0, 2.0]
    with pytest.raises(S2sadError, match="shapes differ|broadcast"):
        vjp(function, (np.ones((2, 3)), np.ones(50)), {"return": 1.0})


def with_any(x, *rest, **options):
    return np.sum(x ** 2) + sum(rest) * options.get("p", 1.0)


@pytest.mark.parametrize("more, options, head, call", [
    ((2.0, 3.0), {}, "x, a", "x, a"), ((), {"p": 3.0}, "x, p", "x, p=p")])
def test_what_a_kernel_has_no_name_for(more, options, head, call):
    x = np.ones(3)
    np.testing.assert_array_equal(gradient(with_any)(x), 2 * x)
    with pytest.raises(S2sadError) as caught:
        gradient(with_any, wrt="x")(x, *more, **options)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message, found.help) == (
        "S405", "'with_any' is given more than its parameters have names for, which *rest and **options would take",
        f"call it in a function that names them: def f({head}): return with_any({call})")
