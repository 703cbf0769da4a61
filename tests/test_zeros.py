"""The law of zeros: what a choice does not take, a seed and a tangent of zero give nothing, in both modes.

Behind each kernel the derivative by each element: of what is taken alone, as one computes it by hand.
"""
# ruff: noqa: PLR0124
from __future__ import annotations

import math

import numpy as np
import pytest

import s2sad
from tests.harness.engines import each, running

FROM_ZERO = np.array([0.0, 1.0, 2.0])
NEGATIVE = np.array([-1.0, 1.0, 2.0])
WITH_NAN = np.array([1.0, np.nan, 3.0])
OVERFLOWING = np.array([-800.0, 0.0, 1.0])
LOG = np.log(2.0)
ROOT = np.sqrt(2.0)

def entropy_by_statements(x):
    logs = np.log(x)
    y = x * logs
    z = np.where(x > 0.0, y, 0.0)
    return np.sum(z)


def entropy_in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        y = x[i] * np.log(x[i])
        s += y if x[i] > 0.0 else 0.0
    return s


def branch_behind(x):
    y = x * np.log(x)
    s = 0.0
    for i in range(x.size):
        if x[i] > 0.0:
            s += y[i]
    return s


def mask_behind(x):
    y = x * np.log(x)
    return np.sum(y[x > 0.0])


def part_behind(x):
    y = x * np.log(x)
    return np.sum(y[1:])


def mask_overwrites(x):
    y = x * np.log(x)
    y[x <= 0.0] = 0.0
    return np.sum(y)


def mask_copies(x):
    y = x * np.log(x)
    z = np.zeros_like(x)
    m = x > 0.0
    z[m] = y[m]
    return np.sum(z)


def sum_where(x):
    y = x * np.log(x)
    return np.sum(y, where=x > 0.0)


def nested_choices(x):
    return np.sum(np.where(x > 0.0, np.where(x > 0.5, x * np.log(x), x / x), 0.0))


def x_log_x(v):
    return v * np.log(v)


def inlined_helper(x):
    y = x_log_x(x)
    return np.sum(np.where(x > 0.0, y, 0.0))


def logarithm(v):
    return np.log(v)


def helper(x):
    s = 0.0
    for i in range(x.size):
        part = logarithm(x[i])
        y = x[i] * part
        if x[i] > 0.0:
            s += y
    return s


def copyto(x):
    y = x * np.log(x)
    np.copyto(y, 0.0, where=x <= 0.0)
    return np.sum(y)


def select(x):
    return np.sum(np.select([x > 0.0], [x * np.log(x)], 0.0))


def nansum(x):
    return np.nansum(x * x)


def nanmean(x):
    return np.nanmean(x * x) * 2.0


def not_nan(x):
    y = x * x
    return np.sum(y[~np.isnan(y)])


def branch_on_nan(x):
    s = 0.0
    for i in range(x.size):
        if not np.isnan(x[i]):
            s += x[i] * x[i]
    return s


def compared_with_itself(x):
    s = 0.0
    for i in range(x.size):
        y = x[i] * x[i]
        if y == y:
            s += y
    return s


def fmax(x):
    return np.sum(np.fmax(x * x, 0.0))


def where_equal(x):
    return np.sum(np.where(x == x, x * x, 0.0))


def nanmax(x):
    return np.nanmax(x * x)


def finite_only(x):
    m = np.isfinite(x)
    return np.sum((x * x)[m])


def roots_of_negatives(x):
    return np.sum(np.maximum(np.where(x > 0.0, np.sqrt(x) * x, 0.0), 0.0))


def double_where(x):
    return np.sum(np.where(x > 0.0, x / np.where(x>0.0,x,0.0) * x, 0.0))


def sinc(x):
    return np.sum(np.where(x != 0.0, np.sin(x) / x * x, x))


def zero_divisor(x):
    c = np.array([0.0, 1.0, 2.0])
    w = x / c
    return np.sum(np.where(c > 0.0, w * x, 0.0))


def clipped(x):
    return np.sum(np.clip(np.where(x > 0, x * np.log(x), 0.0), -10.0, 10.0))


def absolute(x):
    return np.sum(np.abs(np.where(x > 0, x * np.log(x), 0.0)))


def greatest(x):
    return np.max(np.where(x > 0, x * np.log(x), 0.0))


def negative_power(x):
    return np.sum(np.where(x > 0, x ** -0.5 * x, 0.0))


def power_of_itself(x):
    return np.sum(np.where(x > 0, x ** x, 0.0))


def logistic(x):
    return np.sum(1.0 / (1.0 + np.exp(-x)))


def logistic_by_statements(x):
    e = np.exp(-x)
    b = 1.0 + e
    y = 1.0 / b
    return np.sum(y)


def logistic_in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        e = np.exp(-x[i])
        s += 1.0 / (1.0 + e)
    return s


def exponential(v):
    return np.exp(-v)


def logistic_of_helper(x):
    e = exponential(x)
    return np.sum(1.0 / (1.0 + e))


def inverse(e):
    return 1.0 / (1.0 + e)


def logistic_in_helper(x):
    s = 0.0
    for i in range(x.size):
        s += inverse(np.exp(-x[i]))
    return s


def logistic_as_power(x):
    return np.sum((1.0 + np.exp(-x)) ** -1)


def root_times(x):
    return np.sum(np.sqrt(x) * x)


def root_cubed(x):
    r = np.sqrt(x)
    return np.sum(r * r * r)


def root_in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        r = np.sqrt(x[i])
        s += r * r * r
    return s


def power_by_logarithm(x):
    return np.sum(np.exp(2.0 * np.log(x)))


def nan_stays(x):
    return np.sum(np.sqrt(x)*2.0)


def through_infinity(x):
    return np.sum(np.exp(-1.0 / x)) + np.tanh(2.0 / x[0])


def root_of_a_sum(x):
    return np.sqrt(np.sum(x * x)) + (x[0] ** 2 + x[1] ** 2) ** 0.5


def root_of_a_product(x):
    return np.sqrt(x @ x) + np.sqrt(np.dot(x, x) / 2.0)


def root_in_turns(x):
    s, t = 0.0, 1.0
    for i in range(x.size):
        s += 0.5 * x[i] ** 2 + abs(x[i]) * x[i] ** 4
        t += x[i] * x[i]
    return math.sqrt(s) + math.sqrt(s / t) - math.sqrt(t)


def length(d):
    return np.sqrt(np.sum(d * d))


def root_of_helper(x):
    return length(x - x[0]) + length(2.0 * x)


def deviation(x):
    return np.sqrt(np.mean((x - np.mean(x)) ** 2)) + np.std(x) + np.linalg.norm(x)


def distances(x):
    d = x[:, None] - x[None, :]
    lengths = np.sqrt(np.sum(d[:, :, None] ** 2, axis=2))
    return np.sum(lengths) + np.sum(np.where(lengths > 0.0, lengths, 0.0))


def stored_squares(x):
    squares = np.zeros(x.size)
    for i in range(x.size):
        for j in range(x.size):
            squares[i] += (x[i] - x[j]) ** 2
    return np.sum(np.sqrt(squares))


def roots_of_nothing(x):
    return np.sum(np.sqrt(np.sqrt(x * x) + np.hypot(x, x)) ** 2 + np.abs(x) ** 0.5 + np.maximum(x * x, x ** 4) ** 0.5)


def squares_overwritten_by_a_view(x):
    s = x * x
    v = s[1:]
    v[:] = x[1:]
    return np.sum(np.sqrt(s))


def square_rebound(x):
    s = x[0] * x[0]
    t = 0.0
    for i in range(x.size):
        t += np.sqrt(s)
        s = x[i]
    return t


def rows_of_squares(x):
    a = np.zeros((2, x.size))
    a[0] = x * x
    a[1] = x
    return np.sum(np.sqrt(a))


def factor_rebound(x):
    w = 2.0
    t = 0.0
    for i in range(x.size):
        t += np.sqrt(w * x[i] * x[i])
        w = x[i] + 1.0
    return t


def root_of(r2):
    return np.sqrt(r2)


def square_of(d):
    return d * d


def root_in_helper(x):
    t = 0.0
    for i in range(x.size):
        t += root_of(square_of(x[i]))
    return t


def steep_angles(x):
    return np.arcsin(1.0 - x[0] * x[0]) + np.arccos(1.0 - x[1] * x[2]) + np.arctan2(x[0] * x[0], x[2] * x[2])


def roots_of_products(x):
    return np.sum((x * x[::-1]) ** 0.3) + np.cbrt(x[0] * x[2] / (1.0 + x[1])) + np.sqrt(np.sin(x[0]) * np.sin(x[2]))


def weighted_root(x):
    w = np.array([0.0, 1.0, 2.0])
    return np.sqrt(np.sum(w * x))


def products_among_others(x):
    s = np.zeros(2)
    s[0] = x @ x
    s[1] = x[1]
    return np.sum(np.sqrt(s))


def unused(x):
    return np.sum(0.0 * np.sqrt(x) + x)


def root_behind_statements(x):
    v = x * x[::-1]
    w = v * (x - 1.0)
    r = np.sqrt(w)
    return np.sum(r)


def sum_of_roots(w):
    return np.sum(np.sqrt(w))


def roots_in_helper_behind_statements(x):
    """The infinite seed comes from the helper, which sets no flag here."""
    v = x * x[::-1]
    w = v * (x - 1.0)
    return sum_of_roots(w)


def root_in_later_turns(x):
    """Where the first turn is reversed last, a root has been infinite behind it."""
    y = np.zeros(3)
    s = 0.0
    for k in range(3):
        v = x * (x + k)
        y[:] = v * x
        if k > 0:
            s += np.sum(np.sqrt(y))
        y[:] = 1.0
    return s


def roots_on_one_side(x, mode=0):
    v = x * x[0]
    w = v * v[1]
    if mode > 0:
        return np.sum(np.sqrt(w + 1.0))
    return np.sum(np.sqrt(w))


ZEROS = (np.zeros(3), [0.0, 0.0, 0.0])

CASES = [
    *((f, np.array([0.0, 1.0, 0.0]), [0.0, np.inf, 0.0]) for f in (root_behind_statements,
      roots_in_helper_behind_statements)),
    (root_in_later_turns, np.zeros(3), [0.0, 0.0, 0.0]),
    (roots_on_one_side, *ZEROS),
    (unused, FROM_ZERO, [1.0, 1.0, 1.0]),
    (squares_overwritten_by_a_view, np.array([0.0, 1.0, 0.0]), [0.0, 0.5, np.inf]),
    (square_rebound, np.array([0.0, 4.0, 1.0]), [np.inf, 0.25, 0.0]),
    (rows_of_squares, np.array([0.0, 1.0, 4.0]), [np.inf, 1.5, 1.25]),
    (factor_rebound, np.array([0.0, 1.0, 0.0]), [0.5, 1.0, 0.0]),
    (products_among_others, np.zeros(3), [0.0, np.inf, 0.0]),
    (weighted_root, np.zeros(3), [0.0, np.inf, np.inf]),
    *((f, *ZEROS) for f in (root_in_helper, steep_angles, roots_of_products)),
    *((f, *ZEROS) for f in (root_of_a_sum, root_of_a_product, root_in_turns, root_of_helper, deviation, distances,
      stored_squares, roots_of_nothing)),
    (through_infinity, FROM_ZERO, [0.0, np.exp(-1.0), np.exp(-0.5) / 4.0]),
    *((f, FROM_ZERO, [0.0, 1.0, 1.0 + LOG]) for f in (entropy_by_statements, entropy_in_a_loop, branch_behind,
      mask_behind, part_behind, mask_overwrites, mask_copies, sum_where, nested_choices, inlined_helper, helper,
      copyto, select, clipped)),
    *((f, FROM_ZERO, [0.0, 0.0, 1.0 + LOG]) for f in (absolute, greatest)),
    *((f, FROM_ZERO, [0.0, 2.0, 2.0]) for f in (zero_divisor,)),
    *((f, FROM_ZERO, [1.0, np.cos(1.0), np.cos(2.0)]) for f in (sinc,)),
    *((f, FROM_ZERO, [0.0, 0.5, 0.5 / ROOT]) for f in (negative_power,)),
    *((f, FROM_ZERO, [0.0, 1.5, 1.5 * ROOT]) for f in (root_times, root_cubed, root_in_a_loop)),
    *((f, FROM_ZERO, [0.0, 2.0, 4.0]) for f in (power_by_logarithm,)),
    *((f, NEGATIVE, [0.0, 1.5, 1.5 * ROOT]) for f in (roots_of_negatives,)),
    *((f, NEGATIVE, [0.0, 1.0, 1.0]) for f in (double_where,)),
    *((f, NEGATIVE, [0.0, 1.0, 4.0 + 4.0 * LOG]) for f in (power_of_itself,)),
    *((f, WITH_NAN, [2.0, 0.0, 6.0]) for f in (nansum, nanmean, not_nan, branch_on_nan, compared_with_itself, fmax,
      where_equal, finite_only)),
    *((f, WITH_NAN, [0.0, 0.0, 6.0]) for f in (nanmax,)),
    *((f, WITH_NAN, [1.0, np.nan, 1.0 / np.sqrt(3.0)]) for f in (nan_stays,)),
    *((f, OVERFLOWING, [0.0, 0.25, np.e / (1.0 + np.e) ** 2]) for f in (logistic, logistic_by_statements,
      logistic_in_a_loop, logistic_of_helper, logistic_in_helper, logistic_as_power)),
]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kernel, x, slopes, engine", each(CASES))
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
