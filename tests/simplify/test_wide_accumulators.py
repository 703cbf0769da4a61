"""Gradients of float32 kernels are precise to float32, however many gains they are sums of."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import each


def broadcast(x, b):
    return np.sum((x + b) ** 2)


def broadcast_column(x, b):
    return np.sum(x.T * b[:, None])


def elements(x, b):
    s = 0.0
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            s += x[i, j] * b[j]
    return s


def one_element_each(x, b):
    s = 0.0
    for i in range(x.shape[0]):
        s += x[i, 0] * b[0] + x[i, 1] * b[1]
    return s


def with_number(x, b):
    c = b[0] + b[1]
    s = 0.0
    for i in range(x.shape[0]):
        s += c * x[i, 0]
    return s


def scattered(x, b):
    s = 0.0
    for i in range(x.shape[0]):
        s += x[i, 0] * b[i % 2]
    return s


def picked(x, b):
    return np.sum(x[:, 0] * b[np.arange(x.shape[0]) % 2])


def in_steps(x, b):
    s = 0.0
    for i in range(x.shape[0]):
        s += np.sum(x[i] * b)
    return s


def in_a_local_array(x, b):
    c = b * b
    s = 0.0
    for i in range(x.shape[0]):
        s += x[i, 0] * c[0] + x[i, 1] * c[1]
    return s


def rows(x, b):
    c = np.outer(b, b)
    s = 0.0
    for i in range(x.shape[0]):
        s += np.sum(x[i] * c[0])
    return s


def rows_that_are_picked(x, b):
    chosen = np.array([1, 0])
    s = 0.0
    for i in range(x.shape[0]):
        s += np.sum(x[i] * b[chosen])
    return s


ARRAYS = (broadcast, broadcast_column, elements, one_element_each, with_number, scattered, picked, in_steps,
          in_a_local_array, rows, rows_that_are_picked)


def of_arrays(x, a):
    return np.sum(a * x)


def of_elements(x, a):
    s = 0.0
    for i in range(x.shape[0]):
        s += a * x[i, 0]
    return s


NUMBERS = (of_arrays, of_elements)


def given(size):
    return np.full((size, 2), 0.1), np.array([0.3, 0.7])


@pytest.mark.parametrize("kernel, engine", [*((f, "numpy") for f in ARRAYS + NUMBERS), *(
    (f, "numba") for f in (elements, one_element_each, scattered, of_elements))])
def test_long_sums(kernel, engine):
    x, b = given(30_000)
    parameter = "a" if kernel in NUMBERS else "b"
    second = 0.3 if kernel in NUMBERS else b
    exact = s2sad.gradient(kernel, wrt=parameter)(x, second)
    single = 0.3 if kernel in NUMBERS else b.astype("f4")
    found = s2sad.gradient(s2sad.differentiate(kernel, engine=engine), wrt=parameter)(x.astype("f4"), single)
    assert kernel in NUMBERS or found.dtype == np.float32
    np.testing.assert_allclose(found, exact, rtol=1e-6)


@pytest.mark.parametrize("kernel, engine", each(ARRAYS))
def test_derivatives(kernel, engine):
    x, b = given(3)
    check_derivatives(kernel, (x.astype("f4"), b.astype("f4")), ("x", "b"), ("return",), engine)


def complex_number(x, a):
    z, s = 0j, 0.0
    for i in range(x.shape[0]):
        z += x[i, 0] * a * np.exp(1j * a)
        s += abs(z) * a
    return s + z.imag


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_a_complex_number_that_gains_beside_float32_arrays(engine):
    x, _ = given(3)
    check_derivatives(complex_number, (x.astype("f4"), 1.5), ("x", "a"), ("return",), engine)


def element_that_may_not_be(x, b, k):
    s = x[0, 0]
    for i in range(x.shape[0]):
        if k < b.size:
            s += x[i, 0] * b[k]
    return s


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_a_place_that_no_turn_reads_is_not_read_behind_the_loop(engine):
    x, b = given(3)
    for k in (1, 7):
        check_derivatives(element_that_may_not_be, (x.astype("f4"), b.astype("f4"), k), ("x", "b"), ("return",), engine)


def test_elements_that_gain_once_have_no_sum():
    def kernel(u, y):
        for i in range(1, u.size - 1):
            y[i] = u[i - 1] * u[i] + u[i + 1]

    u = np.ones(5, "f4")
    for engine in ("numpy", "numba"):
        assert "_sum" not in s2sad.differentiate(kernel, engine=engine).adjoint_source(u, u.copy())


def products_of_both_precisions(out, x, w):
    for i in range(x.shape[0]):
        scaled = x[i] * (1.0 / np.sqrt(w.size))
        scaled /= np.sum(scaled)
        out[i, :] = scaled @ x[:2]


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_products_of_both_precisions(engine):
    x, b = np.array([[0.3, 0.7], [0.2, 0.9], [0.5, 0.4]], "f4"), np.array([0.3, 0.7])
    check_derivatives(products_of_both_precisions, (np.zeros_like(x), x, b), ("x",), ("out",), engine)
