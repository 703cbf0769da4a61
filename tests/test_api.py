"""How derivatives are called: the law of shadows, annotations, seeds, what primals hold, refusals with their texts."""
from __future__ import annotations

import types
import warnings
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import s2sad
from s2sad import (
    Active, BatchDuplicated, Const, Differentiated, Duplicated, DuplicatedNoNeed, Forward, ForwardWithPrimal, Reverse,
    ReverseWithPrimal, S2sadError, S2sadWarning, autodiff, differentiate, gradient, jvp, make_zero, pipeline,
    value_and_gradient, vjp,
)
from s2sad.live_objects.side_table import forget
from tests.interface import kernels


@pytest.fixture(autouse=True)
def fresh(monkeypatch, tmp_path_factory):
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path_factory.getbasetemp() / "modules"))


@pytest.fixture
def derived(monkeypatch):
    """The requests that reached the pipeline."""
    requests = []
    derive = pipeline.derive
    monkeypatch.setattr(pipeline, "derive",
                        lambda program, request, **given: requests.append(request) or derive(program, request, **given))
    return requests


@pytest.fixture(autouse=True)
def apart():
    """Every test begins with nothing derived: the first call with new types runs with bounds checks."""
    for kernel in vars(kernels).values():
        if isinstance(kernel, types.FunctionType):
            forget(kernel)


@pytest.fixture(params=["numpy", "numba"])
def made(request):
    if request.param == "numba":
        pytest.importorskip("numba")
    return lambda name, **options: Differentiated(getattr(kernels, name), engine=request.param, **options)


def refused(text, call, *args, **keywords):
    with pytest.raises(S2sadError) as caught:
        call(*args, **keywords)
    assert str(caught.value) == text


def test_the_decorator_keeps_the_function():
    f = differentiate(kernels.square)
    assert f.__name__ == "square" and f.__wrapped_kernel__ is kernels.square
    du = np.zeros(3)
    f(du, np.array([1.0, 2.0, 3.0]))
    assert du.tolist() == [1.0, 4.0, 9.0]
    assert differentiate(wrt="u", of=("du",), engine="numpy")(kernels.square).wrt == ("u",)


def test_the_shadow_law(made, derived):
    f = made("square")
    du, u = np.zeros(3), np.array([1.0, 2.0, 3.0])
    du_bar, u_bar = np.ones(3), np.full(3, 10.0)
    for _ in range(2):
        assert f.adjoint(du, du_bar, u, u_bar, 2) in (None, ())
        assert du_bar.tolist() == [0.0, 0.0, 1.0]
        assert u_bar.tolist() == [12.0, 14.0, 10.0]
        du_bar[:], u_bar[:] = 1.0, 10.0
    assert [r.mode for r in derived].count("adjoint") == 1


def test_scalars_come_back_as_a_tuple(made):
    f = made("scale")
    u, u_bar = np.array([1.0, 2.0]), np.array([1.0, 1.0])
    assert f.adjoint(u, u_bar, np.float64(3.0)) == (3.0,)
    assert u_bar.tolist() == [3.0, 3.0]
    u, u_dot = np.array([1.0, 2.0]), np.zeros(2)
    f.tangent(u, u_dot, 3.0, 1.0)
    assert u_dot.tolist() == [1.0, 2.0]


def test_other_layouts_of_memory(made):
    f = made("norm")
    base, bars = np.arange(12.0).reshape(3, 4), np.zeros((4, 3))
    u, u_bar = base[::-1, 1], bars.T[:, 2]
    u.flags.writeable = False
    f.adjoint(u, u_bar, 1.0, 1.0)
    assert np.allclose(u_bar, 2.0 * u)


def test_the_signature_is_said_when_arguments_do_not_fit(made):
    f = made("unused")
    assert f.tangent(3.0, 1.0, 5.0, 1.0) == (2.0,)
    help = "  help: call unused.tangent(x, x_dot, t, t_dot)"
    refused("error[S405]: 'unused.tangent' was given 3 arguments without the shadow 'x_dot' of 'x' or the shadow "
            f"'t_dot' of 't'\n{help}", f.tangent, 3.0, 1.0, 5.0)
    refused("error[S405]: 'unused.tangent' was given 5 arguments that do not fit its signature\n"
            f"  note: given were float, float, float, int, float\n{help}", f.tangent, 3.0, 1.0, 5.0, 1, 1.0)


def test_shadows_are_refused_before_anything_is_written(made):
    f = made("square")
    du, u, du_bar = np.zeros(3), np.ones(3), np.ones(3)
    for _ in range(2):
        refused("error[S403]: the shadow 'u_bar' has shape (2,), its primal 'u' has (3,)\n"
                "  help: make one with s2sad.make_zero(u)", f.adjoint, du, du_bar, u, np.zeros(2), 3)
        refused("error[S403]: the shadow 'u_bar' has dtype float32, its primal 'u' has float64\n"
                "  help: make one with s2sad.make_zero(u)", f.adjoint, du, du_bar, u, np.zeros(3, np.float32), 3)
        refused("error[S404]: the shadow 'du_bar' and the shadow 'u_bar' share memory\n"
                "  help: give each shadow memory of its own: s2sad.make_zero(x)", f.adjoint, du, du_bar, u, du_bar, 3)
        refused("error[S404]: the arguments 'du' and 'u' share memory, and 'du' is written\n"
                "  help: pass a copy of one of them", f.adjoint, u, du_bar, u, np.zeros(3), 3)
        f.adjoint(du, du_bar, u, np.zeros(3), 0)
    locked = np.zeros(3)
    locked.flags.writeable = False
    refused("error[S403]: the shadow 'u_bar' is read-only\n  help: make one with s2sad.make_zero(u)",
            f.adjoint, du, du_bar, u, locked, 3)
    refused("error[S405]: the argument 'du' is read-only, and the function writes it\n"
            "  help: pass a copy of it", f.adjoint, locked, du_bar, u, np.zeros(3), 3)
    assert du.tolist() == [0.0] * 3 and du_bar.tolist() == [1.0] * 3


def test_read_only_arguments_that_are_one_array_share_their_shadow(made):
    f = made("dot")
    x, x_bar = np.array([1.0, 2.0]), np.zeros(2)
    f.adjoint(x, x_bar, x, x_bar, 1.0)
    f.adjoint(x, x_bar, x, x_bar, 1.0)
    assert x_bar.tolist() == [4.0, 8.0]
    assert {k: v.tolist() for k, v in vjp(f, (x, x), {"return": 1.0}).items()} == {"x": [1.0, 2.0], "y": [1.0, 2.0]}


class ArrayLike:
    """Stands for the tensors of other libraries."""
    __slots__ = ()

    def __array__(self, dtype=None, copy=None):
        return np.ones(2)

    def __float__(self):
        return 1.0


@pytest.mark.parametrize(("value", "text"), [
    (np.array(1.0), "is an array of rank 0\n  help: pass the number, u[()], or an array of shape (1,)"),
    (np.zeros(2, np.float16), "has dtype float16\n  help: use float64, float32, complex128, an integer type or bool"),
    (np.zeros(2, np.complex64),
     "has dtype complex64\n  help: use float64, float32, complex128, an integer type or bool"),
    (np.zeros(2, ">f8"), 'has the other byte order\n  help: pass u.astype("float64")'),
    (np.complex64(1j), "is a number of type complex64\n  help: give a complex number"),
    (np.ma.zeros(2), "is a MaskedArray\n  help: pass u.filled(...): what is masked would be read"),
    (np.zeros((1, 2)).view(np.matrix), "is a matrix\n  help: pass numpy.asarray(u)"),
    (np.rec.array([(1.0,)], dtype=[("a", float)]), "is a recarray\n  help: pass numpy.asarray(u)"),
    (np.zeros(2, [("a", float)]),
     "has dtype [('a', '<f8')]\n  help: use float64, float32, complex128, an integer type or bool"),
    (np.zeros(2, object), "has dtype object\n  help: use float64, float32, complex128, an integer type or bool"),
    (np.zeros(2, np.longdouble),
     f"has dtype {np.dtype(np.longdouble)}\n  help: use float64, float32, complex128, an integer type or bool"),
    (np.float16(1.0), "is a number of type float16\n  help: give a float"),
    (np.longdouble(1.0), f"is a number of type {np.dtype(np.longdouble)}\n  help: give a float"),
    (Decimal("1.5"), "is a Decimal\n  help: pass float(u)"), (Fraction(1, 2), "is a Fraction\n  help: pass float(u)"),
    (ArrayLike(), "is an ArrayLike\n  help: pass numpy.asarray(u)"),
    (2 ** 70, f"is {2 ** 70}, which does not fit 64 bits\n  help: give a float"),
    (np.str_("a"), "is a str_\n  help: give an array, a float, an int, a bool, a str or None"),
    (np.datetime64("2000-01-01"), "is a datetime64\n  help: give an array, a float, an int, a bool, a str or None"),
    ({(1, 2): 3.0}, "is a dict\n  help: give an array, a float, an int, a bool, a str or None"),
])
def test_arguments_that_do_not_fit(value, text):
    refused(f"error[S405]: the argument 'u' {text}", gradient(kernels.norm), value)


def test_autodiff_in_reverse(made):
    norm = made("norm")
    u, u_bar = np.array([1.0, 2.0]), np.zeros(2)
    assert autodiff(Reverse, norm, Duplicated(u, u_bar), Active(2.0)) == (5.0,)
    assert u_bar.tolist() == [4.0, 8.0]
    assert autodiff(ReverseWithPrimal, norm, Duplicated(u, u_bar), Active(2), seed=0.5) == ((2.5,), 10.0)
    assert u_bar.tolist() == [6.0, 12.0]
    assert autodiff(Reverse, norm, Duplicated(u, u_bar)) == ()


def test_autodiff_leaves_primals_as_the_function_does(made):
    f = made("square")
    u = np.array([1.0, 2.0, 3.0])
    du, du_bar, u_bar = np.zeros(3), np.ones(3), np.zeros(3)
    autodiff(Reverse, f, Duplicated(du, du_bar), Duplicated(u, u_bar), 3)
    assert du.tolist() == [1.0, 4.0, 9.0] and du_bar.tolist() == [0.0] * 3 and u_bar.tolist() == [2.0, 4.0, 6.0]
    du[:], du_bar[:], u_bar[:] = 0.0, 1.0, 0.0
    autodiff(Reverse, f, DuplicatedNoNeed(du, du_bar), Duplicated(u, u_bar), 3)
    assert u_bar.tolist() == [2.0, 4.0, 6.0]


def test_autodiff_forwards(made):
    scale, pair = made("scale"), made("pair")
    u, u_dot = np.array([1.0, 2.0]), np.array([1.0, 0.0])
    assert autodiff(Forward, scale, Duplicated(u, u_dot), Duplicated(3.0, 1.0)) is None
    assert u_dot.tolist() == [4.0, 2.0] and u.tolist() == [3.0, 6.0]
    assert autodiff(Forward, pair, Duplicated(3.0, 1.0), 4) == (2.0, None, 6.0)
    assert autodiff(ForwardWithPrimal, pair, Duplicated(3.0, 1.0), 4) == ((2.0, None, 6.0), (6.0, 4, 9.0))


def test_a_returned_argument_is_its_name(made):
    f = made("grown")
    u, u_bar = np.array([1.0, 2.0]), np.ones(2)
    derivative, primal = autodiff(ReverseWithPrimal, f, Duplicated(u, u_bar), seed=np.array([1.0, 0.0]))
    assert derivative == () and primal is u and u.tolist() == [3.0, 6.0] and u_bar.tolist() == [6.0, 3.0]
    seeds = {"u": np.ones(2), "return": np.array([1.0, 0.0])}
    assert vjp(f, (u,), seeds)["u"].tolist() == [6.0, 3.0]
    assert vjp(f, (u,), {"return": np.ones(2)})["u"].tolist() == [3.0, 3.0]
    assert seeds["u"].tolist() == [1.0, 1.0] and u.tolist() == [3.0, 6.0]
    tangents = jvp(f, (u,), {"u": np.ones(2)})
    assert tangents["u"].tolist() == [3.0, 3.0] and tangents["return"] is tangents["u"]
    assert f.primal(u) is u


def test_seeds_of_several_results(made):
    f = made("pair")
    assert autodiff(Reverse, f, Active(3.0), 4, seed=(1.0, None, 1.0)) == (8.0,)
    assert vjp(f, (3.0, 4), {"return": (1.0, None, 0.5)}) == {"x": 5.0}
    assert jvp(f, (3.0, 4), {"x": 1.0}) == {"return": (2.0, None, 6.0)}
    refused("error[S403]: the seed of 'return' is missing: the function returns several values\n"
            "  help: give seed=..., shaped as that", autodiff, Reverse, f, Active(3.0), 4)
    refused("error[S403]: the seed of 'return' is a tuple of 2, the result is a tuple of 3\n"
            "  help: give a tuple of the same length, with None for what is no float",
            vjp, f, (3.0, 4), {"return": (1.0, 2.0)})
    refused("error[S403]: the seed of 'return' has a value at 1, where the result is no float\n  help: give None there",
            vjp, f, (3.0, 4), {"return": (1.0, 2.0, 3.0)})


def test_annotations_are_refused():
    u, n = np.ones(2), kernels.norm
    refused("error[S402]: the argument 'u' has no annotation\n  help: say Const(u) or Duplicated(u, u_bar)",
            autodiff, Reverse, n, u)
    refused("error[S402]: the argument 'c' has no annotation\n  help: say Const(c) or Active(c)",
            autodiff, Reverse, n, Const(u), 1.0)
    refused("error[S402]: the argument 'c' is Active, which means nothing in a forward mode\n"
            "  help: use Duplicated(c, c_dot)", autodiff, Forward, n, Const(u), Active(1.0))
    refused("error[S402]: the argument 'u' is Active, but no float\n  help: say Const(u) or Duplicated(u, u_bar)",
            autodiff, Reverse, n, Active(u))
    refused("error[S402]: the argument 'c' is a float, which cannot be Duplicated in reverse\n  help: use Active(c)",
            autodiff, Reverse, n, Const(u), Duplicated(1.0, 0.0))
    refused("error[S402]: the argument 'n' is Duplicated, but holds no floats\n  help: use Const(n)",
            autodiff, Reverse, kernels.square, Const(u), Const(u), Duplicated(np.ones(2, int), np.ones(2, int)))
    refused("error[S402]: the argument 'u' is BatchDuplicated, which is not supported\n"
            "  help: call once for each direction with Duplicated(u, shadow)",
            autodiff, Forward, n, BatchDuplicated(u, (u,)))
    refused("error[S402]: 'Reverse' is no mode\n  help: use Forward, ForwardWithPrimal, Reverse or ReverseWithPrimal",
            autodiff, "Reverse", n)


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


def test_an_index_out_of_bounds_is_found_at_the_first_call(made):
    f = made("square")
    with pytest.raises(IndexError):
        f.adjoint(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), 5)


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


def test_constants_are_compared_at_each_call(made, derived, monkeypatch):
    f = made("gravity")
    assert gradient(f)(1.0) == 2.0
    monkeypatch.setattr(kernels, "G", 5.0)
    assert gradient(f)(1.0) == 5.0 and f.adjoint(1.0, 1.0) == (5.0,)
    made_before = len(derived)
    monkeypatch.setattr(kernels, "G", 2.0)
    assert gradient(f)(1.0) == 2.0
    assert len(derived) == made_before


def test_global_arrays_are_hidden_arguments(made, monkeypatch):
    f = made("looked_up")
    assert gradient(f)(1.0, 1) == 2.0 and f.adjoint(1.0, 1, 1.0) == (2.0,) and f.primal(2.0, 1) == 4.0
    monkeypatch.setattr(kernels, "TABLE", kernels.TABLE.copy())
    assert gradient(f)(1.0, 1) == 2.0
    kernels.TABLE[1] = 7.0
    assert gradient(f)(1.0, 1) == 7.0 and f.adjoint(1.0, 1, 1.0) == (7.0,)
    monkeypatch.setattr(kernels, "TABLE", np.array([0.0, 9.0]))
    assert gradient(f)(1.0, 1) == 9.0 and f.adjoint(1.0, 1, 1.0) == (9.0,) and f.primal(2.0, 1) == 18.0


def test_the_bare_function_and_the_text(made):
    f = made("square")
    du, u = np.zeros(3), np.ones(3)
    bare = f.compiled("adjoint", du, np.ones(3), u, np.zeros(3), 3)
    u_bar = np.zeros(3)
    bare(du, np.ones(3), u, u_bar, 3)
    assert u_bar.tolist() == [2.0] * 3
    assert f.adjoint_source(du, u).count("def square_adjoint(du, du_bar, u, u_bar, n):") == 1
    assert made("scale").tangent_source(u, 1.0).count("def scale_tangent(u, u_dot, c, c_dot):") == 1
    f.compiled("primal", du, u, 3)(du, 2.0 * u, 3)
    assert du.tolist() == [4.0] * 3


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
