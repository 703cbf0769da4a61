"""The order in which arrays lie in memory: where NumPy makes a copy in another one, and where it takes a view."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.views.memory_order import COPIED, HOW, given, lying
from tests.harness.derivatives import check_derivatives, check_value
from tests.harness.engines import each, running


@pytest.mark.parametrize("kernel, engine", each(COPIED))
def test_what_is_made_in_the_order_of_c_is_contiguous(kernel, engine):
    for how in HOW[:2 if engine == "numba" else 4]:
        check_value(kernel, (lying((2, 4), how),), ("u",), engine=engine)


# -- an argument whose order tells is asked -------------------------------------------------------------
def in_its_order(u):
    w = np.copy(u)
    f = w.ravel()
    f[1] *= 3.0
    return np.sum(w ** 2)


def computed(u):
    w = u * 2.0
    f = w.reshape(-1)
    f[1] *= 3.0
    return np.sum(w ** 2)


def alias_in_order(u):
    w = np.asarray(u, order="C")
    w[0, 0] = 0.0
    return np.sum(u ** 2)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
@pytest.mark.parametrize("kernel", (in_its_order, computed, alias_in_order))
def test_an_argument_whose_order_tells_is_asked(kernel, engine):
    check_derivatives(kernel, (given(2, 4),), ("u",), ("return",), engine=engine)
    with running(engine) as under:
        function = s2sad.differentiate(kernel, engine=under)
        for how in ("F", "strided"):
            with pytest.raises(s2sad.S2sadError) as refused:
                s2sad.gradient(function)(lying((2, 4), how))
            assert str(refused.value) == (
                "error[S405]: 'u' is not contiguous, where it or an array made like it is reshaped and written\n"
                "  note: NumPy writes a copy of it then\n"
                "  help: pass np.ascontiguousarray(...), or write it as a loop")
            with pytest.raises(s2sad.S2sadError, match="is not contiguous"):
                s2sad.autodiff(s2sad.ReverseWithPrimal, function,
                               s2sad.Duplicated(lying((2, 4), how), np.zeros((2, 4))))
            with pytest.raises(s2sad.S2sadError, match="is not contiguous"):
                s2sad.jvp(function, (lying((2, 4), how),), {"u": np.ones((2, 4))})


# -- a power that is a float64 number whatever it is of -------------------------------------------------
def powers(x, y):
    z = np.float_power(x, y)
    return np.sum(z * np.float_power(y, 2))


@pytest.mark.parametrize("engine", ("numpy", "loops", "numba"))
def test_a_power_of_singles_is_a_double(engine):
    x, y = given(3).astype(np.float32), given(3).astype(np.float32)
    for a, b in ((x, y), (x[:1], y), (x, given(3))):
        check_derivatives(powers, (a, b), ("x", "y"), ("return",), engine=engine)
        with running(engine) as under:
            value, _ = s2sad.value_and_gradient(s2sad.differentiate(powers, engine=under))(a, b)
        assert abs(value - powers(a, b)) < 1e-13
