"""The law of zeros: what a choice does not take, a seed and a tangent of zero give nothing, in both modes.

Behind each kernel of `choices` and `roots` stands the derivative by each element: of what is taken alone, as one
computes it by hand.
"""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.engines import each, running
from tests.differentiate import choices, roots


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kernel, x, slopes, engine", each([*roots.CASES, *choices.CASES]))
def test_both_modes(kernel, x, slopes, engine):
    with running(engine) as run_under:
        f = s2sad.differentiate(kernel, engine=run_under)
        found = s2sad.gradient(f)(x)
        tangents = [s2sad.jvp(f, (x,), {"x": e})["return"] for e in np.eye(3)]
    np.testing.assert_allclose(found, slopes, rtol=1e-12)
    np.testing.assert_allclose(tangents, slopes, rtol=1e-12)


def quotient_of_a_quotient(x):
    return 1.0 / (1.0 + 1.0 / x)


def product_of_an_infinite_tangent(x):
    return np.sum(np.zeros((3, 3)) @ np.sqrt(x))


def test_what_forwards_is_nan_where_it_is_zero_backwards():
    """Neither a quotient behind a quotient nor a product of matrices is asked forwards: that would cost everywhere."""
    assert s2sad.gradient(quotient_of_a_quotient)(0.0) == 0.0
    assert np.isnan(s2sad.jvp(quotient_of_a_quotient, (0.0,), {"x": 1.0})["return"])
    np.testing.assert_array_equal(s2sad.gradient(product_of_an_infinite_tangent)(np.zeros(3)), np.zeros(3))
    assert np.isnan(s2sad.jvp(product_of_an_infinite_tangent, (np.zeros(3),), {"x": np.ones(3)})["return"])


def weighted(x, w):
    return np.sqrt(np.sum(w * x * x))


def root(x):
    return np.sqrt(x[0]) + np.sqrt(x[1] * x[2])


def differing(x, w):
    s = 0.0
    for i in range(x.size):
        d = x[i] - x[i - 1]
        s += np.sqrt(2.0 * d * d) + np.sqrt(w * d * d) + np.sqrt(d * w * d * d * d / 2.0) + (3.0 * d * d) ** 0.75
    return s


def barely_shifted(x):
    return np.sqrt(np.sum(x * x) + 1e-50)


def of_two_factors(x):
    return np.sqrt(2.0 * x[0] * x[1] * x[0]) + np.sqrt(x[2] * x[2] * x[2])


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_the_root_of_a_square_among_other_factors(engine):
    """However the product is put together; what is left beside squares has to be held fixed, or to be a square."""
    with running(engine) as run_under:
        kernel = s2sad.differentiate(differing, wrt="x", engine=run_under)
        np.testing.assert_array_equal(s2sad.gradient(kernel)(np.zeros(3), 2.0), np.zeros(3))
        assert s2sad.jvp(kernel, (np.zeros(3), 2.0), {"x": np.ones(3)})["return"] == 0.0
        found = s2sad.gradient(s2sad.differentiate(of_two_factors, engine=run_under))(np.array([1.0, 0.0, 4.0]))
        np.testing.assert_array_equal(found, [0.0, np.inf, 3.0])


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_what_float32_takes_for_0_is_not_never_zero(engine):
    with running(engine) as run_under:
        found = s2sad.gradient(s2sad.differentiate(barely_shifted, engine=run_under))(np.zeros(2, "float32"))
    np.testing.assert_array_equal(found, np.zeros(2, "float32"))


def shifted_root(x):
    return np.sum(np.sqrt(1.0 + x * x))


def test_a_root_of_what_may_have_a_slope_is_infinite_there():
    """Weights may have any sign: what they sum to may be 0 where its slope is not."""
    np.testing.assert_array_equal(s2sad.gradient(root)(np.array([0.0, 0.0, 2.0])), [np.inf, np.inf, 0.0])
    found = s2sad.gradient(weighted, wrt="x")(np.array([1.0, 1.0]), np.array([1.0, -1.0]))
    np.testing.assert_array_equal(found, [np.inf, -np.inf])


def test_a_root_that_is_never_zero_is_not_asked():
    for engine in ("numpy", "numba"):
        assert "!= 0.0" not in s2sad.differentiate(shifted_root, engine=engine).adjoint_source(np.ones(3))


def after_roots(x, y):
    v = x * y
    w = v * (x + y)
    r = np.sqrt(w)
    return np.sum(r * r * v)


def test_partials_of_arrays_are_asked_by_a_flag():
    """One test for each root, whatever is in front of it."""
    text = s2sad.differentiate(after_roots, engine="numpy").adjoint_source(np.ones(3), np.ones(3))
    assert text.count("!= 0.0") == 1 and text.count("np.isfinite") == 1 and text.count("strong_zero(") > 3


def test_nothing_is_asked_where_all_is_finite():
    def kernel(x, y):
        z = x * y
        return np.sum(np.where(x > 0.0, z * z, np.maximum(np.sin(z), y)))

    for engine in ("numpy", "numba"):
        assert "!= 0.0" not in s2sad.differentiate(kernel, engine=engine).adjoint_source(np.ones(3), np.ones(3))


def cube_root(x):
    return np.cbrt(x)


def tenth_power(x):
    return x ** 0.1


def third_power(x):
    return x ** (1 / 3)


def cube_roots(x):
    return np.sum(np.cbrt(x))


def tenth_powers(x):
    return np.sum(x ** 0.1)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", [cube_root, tenth_power, third_power, cube_roots, tenth_powers])
def test_roots_are_steep_at_zero_and_flat_at_infinity(kernel, engine):
    at = [np.array([v]) if kernel in (cube_roots, tenth_powers) else v for v in (0.0, -0.0, 1.0, np.inf)]
    with running(engine) as named:
        f = s2sad.gradient(s2sad.differentiate(kernel, engine=named))
        slopes = [float(np.ravel(f(v))[0]) for v in at]
    assert slopes == [np.inf, np.inf, 0.1 if "tenth" in kernel.__name__ else 1 / 3, 0.0]
