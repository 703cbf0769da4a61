"""Statistics that pass over nans or are of several variables, sums of parts in a row, polynomials, borders."""
from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import polynomial

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import each, running, one_line

X = np.array([-1.2, 0.7, 1.4, 0.3])
A = np.array([[0.3, -0.9, 0.7], [0.5, 0.2, -0.6]])


def without_nans(x, a):
    v = a * a[0, 0]
    v[0, 1] = np.nan
    total = np.nanmax(v) * np.nanmin(v) + np.sum(np.nanmax(v, axis=0) * x[:3]) + np.sum(np.nanmin(v, axis=1) ** 2)
    total += np.nanvar(v) + np.sum(np.nanvar(v, axis=1, ddof=1) * x[:2]) + np.nanstd(v, ddof=1) * x[1]
    total += np.sum(np.nanstd(v, axis=1, keepdims=True) * a) + np.sum(np.nancumsum(v) ** 2)
    return total + np.sum(np.nancumsum(v, axis=1) * a)


def in_parts(x, a):
    total = np.sum(np.add.reduceat(x, [0, 2, 1, 3]) ** 2 * np.arange(4.0))
    return total + np.sum(np.add.reduceat(a, np.array([0, 1]), axis=1) ** 2 * a[:, :2])


def of_variables(x, a):
    total = np.sum(np.cov(a) ** 2 * np.arange(4.0).reshape(2, 2)) + np.cov(x) * x[0] + np.cov(x, ddof=0)
    total += np.sum(np.cov(x, x ** 3, bias=True) ** 2) + np.sum(np.cov(a, rowvar=False) * a[0])
    return total + np.corrcoef(x, x ** 2)[0, 1] * x[1] + np.sum(np.corrcoef(a)[1] * a[:, 0])


def polynomials(x, a):
    total = np.sum(np.polyfit(np.arange(4.0), x, 2) ** 2) + np.sum(np.polyfit(x, x ** 3 + np.arange(4.0), 1) * a[:, 0])
    total += np.sum(np.polyder(x) * x[1:]) + np.sum(np.polyint(x) ** 2) + np.sum(np.polymul(x, a[0]) ** 2)
    return total + np.polynomial.polynomial.polyval(x[0], x) + np.sum(polynomial.polyval(x, a[1]) ** 2)


def bordered(x, a):
    weights = np.arange(8.0)
    total = np.sum(np.pad(x, 2, mode="linear_ramp") ** 2 * weights) + np.sum(np.pad(x, 2, mode="mean") ** 2 * weights)
    total += np.sum(np.pad(a, ((1, 2), (0, 3)), mode="maximum") ** 2) + np.sum(np.pad(a, 1, mode="minimum") ** 3)
    return total + np.sum(np.pad(a, (2, 1), mode="linear_ramp") ** 2) + np.sum(np.pad(a, 1, mode="mean") ** 3)


def spaced(x, a):
    total = np.sum(np.logspace(x[0], x[1], 5) ** 2) + np.sum(np.logspace(0, x[3], 3, base=2.0) * x[:3])
    total += np.sum(np.geomspace(x[1], x[2], 4) * x) + np.sum(np.geomspace(1.0, x[2], 3, endpoint=False) * x[1:])
    return total + np.sum(np.ldexp(x, 2) ** 2) + np.sum(np.ldexp(a, np.array([0, 1, -3])) ** 2)


@pytest.mark.parametrize(("kernel", "engine"), each((
    of_variables, without_nans, in_parts, polynomials, spaced, bordered)))
def test_derivatives(kernel, engine):
    check_derivatives(kernel, (X, A), ("x", "a"), ("return",), engine)


@pytest.mark.parametrize(("kernel", "engine"), each((in_parts, without_nans, bordered), "single"))
def test_single_precision(kernel, engine):
    check_derivatives(kernel, (X.astype("float32"), A.astype("float32")), ("x", "a"), ("return",), engine)


def of_one(x):
    return (np.nanmax(x) ** 2 + np.nanvar(x) + np.sum(np.add.reduceat(x, [0]) ** 2) + np.sum(np.polyint(x) ** 2)
            + np.sum(np.polyder(x)) + np.sum(np.pad(x, 1, mode="mean") ** 2) + np.cov(x, bias=True)
            + np.sum(np.polyfit(x, x, 0)))


def of_several(x, a):
    few = np.stack((x[:2], x[1:3]))
    return (np.sum(np.cov(x, x * x, ddof=0) ** 2) + np.sum(np.cov(a, rowvar=False) ** 2) + np.cov(x) * x[0]
            + np.sum(np.corrcoef(a) * a[:, :1]) + np.sum(np.cov(few, ddof=1)[0]))


def in_double(x, a):
    return np.cov(x, bias=True), np.cov(x, x * x), np.corrcoef(a)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_variables_of_single_precision(engine):
    given = X.astype("float32"), A.astype("float32")
    check_derivatives(of_several, given, ("x", "a"), ("return",), engine)
    with running(engine) as under:
        kernel = s2sad.differentiate(in_double, engine=under)
        changes = s2sad.jvp(kernel, given, {"x": given[0], "a": given[1]}, of=("return",))["return"]
    assert [c.dtype for c in changes[1:]] == ["float64"] * 2
    assert type(changes[0]) is float or changes[0].dtype == "float64"


def covariance(x, c):
    return np.sum(np.cov(x[None]) * np.ones(3))


def covariance_of_columns(x, c):
    return np.sum(np.cov(x[:, None], rowvar=False) * np.ones(3))


def correlation(x, c):
    return np.sum(np.corrcoef(np.reshape(x, (1, -1))) * x)


def largest(x):
    return np.sum(np.nanmax(x, axis=1) * np.array([1.0, 2.0]))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_edges(engine):
    check_derivatives(of_one, (np.array([0.7]),), ("x",), ("return",), engine)
    with running(engine) as under:
        kernel = s2sad.differentiate(largest, engine=under)
        value, found = s2sad.value_and_gradient(kernel)(np.array([[np.nan, np.nan], [1.0, np.nan]]))
    assert np.isnan(value) and found[1].tolist() == [2.0, 0.0]


def product(x, c):
    return np.sum(np.polymul(x, np.array([c, 1.0])))


def between(x, c):
    return np.sum(np.geomspace(x[1], c, 3))


@pytest.mark.parametrize(("kernel", "message"), [
    (product, "np.polymul leaves leading zeros out: write np.convolve"),
    (between, "np.geomspace between numbers above 0"),
    (covariance, "np.cov of one variable is a number: give it as an array with one axis"),
    (covariance_of_columns, "np.cov of one variable is a number: give it as an array with one axis"),
    (correlation, "np.corrcoef of one variable is a number: give it as an array with one axis")])
def test_guards(kernel, message):
    with pytest.raises(s2sad.S2sadError) as guarded:
        s2sad.gradient(s2sad.differentiate(kernel, engine="numpy"), wrt="x")(X, 0.0)
    assert one_line(guarded.value) == message


def freely(x):
    return np.sum(np.nanvar(x, ddof=2))


def weighted(x):
    return np.sum(np.polyfit(x, x, 1, w=x))


@pytest.mark.parametrize(("kernel", "message"), [
    (freely, "no derivative rule for numpy.nanvar"), (weighted, "no derivative rule for numpy.polyfit with w=")])
def test_refused(kernel, message):
    with pytest.raises(s2sad.S2sadError) as refused:
        s2sad.gradient(kernel)(X)
    assert refused.value.diagnostics[0].message == message
