"""Float32 arrays that meet wider dtypes: the results have NumPy's dtype, and the values that go with it."""
from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.special

import s2sad
from s2sad import pipeline, read
from s2sad.infer.types import of_value
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running

A, K, P = np.float32([0.5, 1.7, 2.2]), np.array([3, 1, 2]), np.array([1.5, 2.5, 3.5])
BIG = np.array([1e8])
STRONG = np.float64(2.0)
WEAK = 2.0


def first(p):
    return p[0] * 2.0


def of_python(p):
    return float(p[0])


def wide(a, k, p, t, words):
    return (a + p[0], a * k, a + words, a + k[0], a + np.sum(p), a + np.float64(t), a + np.sqrt(t), a + p[0] * t,
            a + (p[0] + k[0]), np.mean(k) * a, a ** k, -k / a, a + np.max(p) * (1.0 if t > 9.0 else p[1]), sum(p) * a,
            first(p) * a, a + STRONG, a @ k * a, np.linalg.norm(p) * a, abs(p[0]) * a, a + (p[0] if t > 0.0 else 1.0))


def narrow(a, k, p, t, words):
    return (a + 2.0, a + 2, a + t, a + float(p[0]), a + int(k[0]), a + np.float32(p[0]), a + math.sqrt(p[0]), a * a[0],
            a + a[0] * 2.0, a + a.size, a + a.shape[0] * 0.5, a + WEAK, of_python(p) * a,
            a * (p[0] > 0.0), np.mean(a) * a, a + k.astype(np.float32), np.maximum(a, 0.0),
            np.where(a > 0.5, a, t), np.linspace(a[0], a[1], 4), a ** 2)


def joined(a, k, p, t, words):
    return (np.concatenate((a, k)), np.stack((a, k)), np.hstack((a, k)), np.append(a, 2.0), np.append(a, p[0]),
            np.array([a[0], k[0]]), np.array([a[0], 2]), np.where(a > 0.5, a, p[0]), np.maximum(a, k),
            np.add.outer(a, k), np.outer(a, k), np.clip(a, p[0], 9.0), np.cross(a, k), np.kron(a, k), np.hypot(a, p[0]),
            np.concatenate((a, [p[0]])), np.einsum("i,i->i", a, k), np.r_[a, k])


@pytest.mark.parametrize("kernel", [wide, narrow, joined])
def test_dtypes_of_results(kernel):
    arguments = (A, K, P, 0.3, np.int32(K))
    found = pipeline.summary(read.load(kernel), tuple(map(of_value, arguments)))
    assert [t.dtype for t in found.results] == [r.dtype.name for r in kernel(*arguments)]


def by_an_element(a, p, k):
    s = a + p[0]
    d = s - p[0]
    return np.sum(d * d)


def by_integers(a, p, k):
    s = a + k
    d = s - k
    return np.sum(d * d)


def in_a_loop(a, p, k):
    s = a
    for _ in range(3):
        s = s + p[0]
    d = s - 3 * p[0]
    return np.sum(d * d)


def shifted(a, s):
    return a + s


def through_functions(a, p, k):
    return np.sum((shifted(a, p[0]) - 0.5 * first(p)) ** 2)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [by_an_element, by_integers, in_a_loop, through_functions])
def test_values(kernel, engine):
    arguments = (A, BIG, np.array([10 ** 8, 10 ** 8 + 1, 10 ** 8 + 7]))
    with running(engine) as under:
        value, gradient = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=under), wrt="a")(*arguments)
    np.testing.assert_allclose(value, kernel(*arguments), rtol=1e-12)
    assert abs(value - 7.98) < 1e-5 and gradient.dtype == np.float32
    np.testing.assert_allclose(gradient, 2.0 * A, rtol=1e-6)


def written_beside(a):
    y = np.float64(a)
    y[0] = y[1] * y[2]
    return np.sum(y * a)


@pytest.mark.parametrize(("dtype", "expected"), [(np.float32, [6.0, 7.0, 8.0]), (np.float64, [0.0, 40.0, 30.0])])
def test_a_conversion_copies_where_the_dtype_is_another_one(dtype, expected):
    a = np.array([1.0, 2.0, 3.0], dtype)
    np.testing.assert_array_equal(s2sad.gradient(written_beside)(a), np.array(expected, dtype))


def kept(a, s):
    return np.sum((a + s - s) ** 2)


def given_a_number(a, p):
    return kept(a, float(p[0]))


# -- functions whose results have a dtype of their own ---------------------------------------------------------------

def columns(a):
    return np.vander(a, 3)


def with_a_number(a):
    return scipy.special.xlogy(a, 0.5)


def of_a_number(a):
    return scipy.special.xlog1py(2, a)


def with_an_array(a):
    return scipy.special.xlogy(a, a)


def sums_in_bins(a):
    return np.histogram(K, bins=2, range=(1, 3), weights=a)[0]


def sums_between_edges(a):
    return np.histogram(a, bins=np.array([0.0, 1.0, 3.0]), weights=a)[0]


def edges(a):
    return np.histogram(a, bins=2, range=(0, 3))[1] * a


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel", [
    columns, with_a_number, of_a_number, with_an_array, sums_in_bins, sums_between_edges, edges])
def test_dtypes_of_their_own(kernel, engine):
    check_derivatives(kernel, (A,), ("a",), ("return",), engine)
    with running(engine) as under:
        differentiated = s2sad.differentiate(kernel, engine=under)
        changes = s2sad.jvp(differentiated, (A,), {"a": A}, of=("return",))["return"]
    assert changes.dtype == kernel(A).dtype


def test_a_function_that_is_given_a_number_of_python():
    converted = s2sad.differentiate(given_a_number, engine="numpy")
    assert s2sad.value_and_gradient(converted, wrt="a")(A, BIG)[0] == given_a_number(A, BIG)
