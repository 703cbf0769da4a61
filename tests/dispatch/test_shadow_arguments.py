"""Shadows that are missing, or are none."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.dispatch.kernels import product, scaled
from tests.dispatch.test_later_arguments import refused

SIGNATURES = {"scaled": "v, v_bar, u, u_bar, k, n, result_bar", "product": "v, v_bar, a, a_bar, x, x_bar"}


@pytest.mark.parametrize("kernel, shapes, said", [
    (scaled, (3, 3, 3, 2.0, 4, 1.0), "6 arguments without the shadow 'v_bar' of 'v' or the shadow 'u_bar' of 'u'"),
    (scaled, (3, 3, 3, 3, 2.0, 4), "6 arguments without the seed 'result_bar'"),
    (scaled, (3, 3, 2.0, 4, 1.0), "5 arguments without the shadow 'v_bar' of 'v' and the shadow 'u_bar' of 'u'"),
    (product, (2, 2, (2, 3), 3, 3), "5 arguments without the shadow 'a_bar' of 'a'"),
    (product, (2, 2, (2, 3), (2, 3), 3), "5 arguments without the shadow 'x_bar' of 'x'"),
    (product, (2, (2, 3), (2, 3), 3, 3), "5 arguments without the shadow 'v_bar' of 'v'"),
    (product, (2, (2, 3), 3, 3), "4 arguments without the shadow 'v_bar' of 'v' and the shadow 'a_bar' of 'a'"),
])
def test_the_shadow_that_is_missing_is_named(f, kernel, shapes, said):
    f = s2sad.differentiate(kernel, engine=f.engine)
    integer = 4      # the number of trips, no shape
    arguments = [s if isinstance(s, float) else 3 if s is integer else np.ones(s) for s in shapes]
    name = kernel.__name__
    refused("S405", f"'{name}.adjoint' was given {said}", f"call {name}.adjoint({SIGNATURES[name]})",
            f.adjoint, *arguments)


@pytest.mark.parametrize("shadow, what", [
    (None, "is None, its primal 'u' is an array"), ([0.0] * 3, "is a list, its primal 'u' is an array"),
    ("u", "is a str, its primal 'u' is an array"), (np.zeros(4), "has shape (4,), its primal 'u' has (3,)"),
    (np.zeros((3, 1)), "has shape (3, 1), its primal 'u' has (3,)"),
    (np.zeros(3, "f4"), "has dtype float32, its primal 'u' has float64"),
    (np.zeros(3, int), "has dtype int64, its primal 'u' has float64"),
    (np.zeros(3, ">f8"), "has dtype >f8, its primal 'u' has float64"),
])
def test_what_is_no_shadow(f, shadow, what):
    for _ in range(2):
        refused("S403", f"the shadow 'u_bar' {what}", "make one with s2sad.make_zero(u)",
                f.adjoint, np.zeros(3), np.zeros(3), np.ones(3), shadow, 2.0, 3, 1.0)
        f.adjoint(np.zeros(3), np.zeros(3), np.ones(3), np.zeros(3), 2.0, 3, 1.0)


def test_what_cannot_be_read_is_said_with_what_was_given(f):
    with pytest.raises(s2sad.S2sadError) as caught:
        f.adjoint(np.zeros(3), np.zeros(3), np.ones(3), np.zeros(3), 2.0, 3, 1.0, 1.0)
    array = "an array of float64 of shape (3,)"
    assert str(caught.value) == (
        "error[S405]: 'scaled.adjoint' was given 8 arguments that do not fit its signature\n"
        f"  note: given were {array}, {array}, {array}, {array}, float, int, float, float\n"
        "  help: call scaled.adjoint(v, v_bar, u, u_bar, k, n, result_bar)")
