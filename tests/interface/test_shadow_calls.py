"""How derivatives are called with shadows: the law, the signature, constants and hidden arguments, refusals."""
from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from s2sad import differentiate, gradient, vjp
from tests.interface import kernels
from tests.harness.refusals import refused

pytestmark = pytest.mark.usefixtures("fresh", "apart")


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
    ({b"a": 3.0}, "is a dict\n  help: give an array, a float, an int, a bool, a str or None"),
])
def test_arguments_that_do_not_fit(value, text):
    refused(f"error[S405]: the argument 'u' {text}", gradient(kernels.norm), value)


def test_an_index_out_of_bounds_is_found_at_the_first_call(made):
    f = made("square")
    with pytest.raises(IndexError):
        f.adjoint(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), 5)


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
