"""Functions of scipy.special: elementwise ones, and sums of exponentials."""
from __future__ import annotations

import numpy as np
import pytest
import scipy.special as sp
from scipy import special
from scipy.special import expit, logsumexp

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import each, running

X = np.array([-1.2, 0.7, 1.4])
FAR = np.array([-700.0, -40.0, 0.0, 40.0, 800.0])
ROWS = np.array([[0.2, -1.0, 3.0], [800.0, 801.0, 799.5]])


def logistic(x):
    return np.sum(expit(x) * sp.logit(0.25 + 0.5 * expit(x))) + np.sum(sp.log_expit(x) * x) + sp.expit(x[0])


def error_functions(x):
    special_2 = np.sum(special.erf(x) + sp.erfc(x ** 2)) + sp.erf(x[0]) * special.erfc(x[1])
    return special_2 + np.sum(sp.ndtr(x) * x) + sp.ndtr(x[2] - 1.0)


def entropies(x):
    y = np.exp(x)
    found = sp.xlogy(y, y * y) + sp.xlog1py(x, y) + sp.entr(y) + sp.rel_entr(y, y + 1.0) + sp.kl_div(y, y * y)
    return np.sum(found * y) + sp.xlogy(y[0], 2.0) + sp.xlogy(0.5, y[1]) + sp.entr(y[2])


def others(x):
    y = sp.exp10(x) + sp.cbrt(x) + sp.exp2(x) + sp.expm1(x) + sp.log1p(x ** 2)
    return np.sum(y * sp.gammaln(x ** 2 + 0.1)) + sp.gammaln(x[1] ** 2)


def sums_of_exponentials(x):
    special = np.outer(x, x ** 2)
    total = logsumexp(special) + np.sum(sp.logsumexp(special, axis=0) * x) + sp.logsumexp(special, axis=(0, 1))
    return total + np.sum(sp.logsumexp(special, axis=1, keepdims=True) * special) + np.sum(expit(special))


def shares(x):
    y = np.outer(x, x)
    return (np.sum(sp.softmax(y, axis=1) * y) + np.sum(sp.softmax(x) * x ** 2) + np.sum(sp.softmax(y) * y ** 2)
            + np.sum(sp.log_softmax(y, axis=0) * y) + np.sum(sp.log_softmax(y) * y))


def in_place(x):
    for _ in range(2):
        x[:] = expit(x) * sp.erf(x)
    np.exp(x, out=x)
    sp.expit(x, out=x)
    return np.sum(x ** 2)


@pytest.mark.parametrize(("kernel", "engine"), each((
    logistic, error_functions, entropies, others, sums_of_exponentials, shares, in_place)))
def test_derivatives(kernel, engine):
    check_derivatives(kernel, (X,), ("x",), ("return",), engine)


@pytest.mark.parametrize(("kernel", "engine"), each((
    logistic, error_functions, entropies, sums_of_exponentials, shares), "single"))
def test_single_precision(kernel, engine):
    check_derivatives(kernel, (X.astype("float32"),), ("x",), ("return",), engine)


def of_one(x):
    return np.sum(sp.softmax(x, axis=0) * x) + sp.logsumexp(x) ** 2 + np.sum(sp.log_softmax(x) * x) + np.sum(expit(x))


def of_a_matrix(n):
    return np.sum(sp.softmax(np.array([[n, 1.0], [2.0, 3.0]]), axis=1)[0] * np.array([1.0, 2.0]))


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_sizes(engine):
    check_derivatives(of_one, (np.array([0.7]),), ("x",), ("return",), engine)
    check_derivatives(of_a_matrix, (0.3,), ("n",), ("return",), engine)
    check_derivatives(logistic_sum, (np.zeros(0),), ("x",), ("return",), engine)


def logistic_sum(x):
    return np.sum(expit(x))


def total(x):
    return np.sum(sp.logsumexp(x, axis=1))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_far_out(engine):
    """No overflow, no cancellation: shares of what is far above 1, and of nothing."""
    with running(engine) as under:
        found = s2sad.gradient(s2sad.differentiate(logistic_sum, engine=under))(FAR)
        np.testing.assert_allclose(found, np.exp(-np.abs(FAR)) / (1.0 + np.exp(-np.abs(FAR))) ** 2, rtol=1e-13)
        whole = s2sad.differentiate(total, engine=under)
        np.testing.assert_allclose(s2sad.gradient(whole)(ROWS), sp.softmax(ROWS, axis=1), rtol=1e-13)
        assert s2sad.value_and_gradient(whole)(ROWS)[0] == pytest.approx(total(ROWS), rel=1e-14)
        below = np.array([[-np.inf, -np.inf], [0.0, -np.inf]])
        value, shares = s2sad.value_and_gradient(whole)(below)
        assert value == -np.inf and shares[1].tolist() == [1.0, 0.0]


def divergence(p, q):
    return np.sum(sp.rel_entr(p, q)) + np.sum(sp.xlogy(p, q))


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_nothing_times_its_logarithm(engine):
    p, q = np.array([0.0, 0.25]), np.array([0.0, 0.5])
    with running(engine) as under:
        found = s2sad.gradient(s2sad.differentiate(divergence, engine=under), wrt="q")(p, q)
    np.testing.assert_array_equal(found, [0.0, 0.0])


def test_generated_text():
    def kernel(x):
        return np.sum(special.expit(x))
    source = s2sad.differentiate(error_functions, engine="numpy").adjoint_source(X)
    assert "from scipy import special\n" in source and "special.erfc" in source
    assert "scipy" not in s2sad.differentiate(kernel, engine="numba").adjoint_source(X)


def weighted(x):
    return sp.logsumexp(x, b=x)


def inverse(x):
    return np.sum(sp.erfinv(x))


REFUSED = [
    (weighted, "no derivative rule for scipy.special.logsumexp", "without b= and return_sign=: write s + "
     "np.log(np.sum(b * np.exp(a - s))) with s = np.max(a)"),
    (inverse, "'sp.erfinv' is not a function that s2sad can read", "write it with numpy and math, or give its "
     'derivative: s2sad.rule("scipy.special.erfinv(x)", x=...)'),
]


@pytest.mark.parametrize(("kernel", "message", "help"), REFUSED)
def test_refused(kernel, message, help):
    with pytest.raises(s2sad.S2sadError) as refused:
        s2sad.gradient(kernel)(X)
    assert (refused.value.diagnostics[0].message, refused.value.diagnostics[0].help) == (message, help)


def logarithms(x):
    return sp.gammaln(x)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
def test_poles(engine):
    x = np.array([0.0, -0.0, -1.0, -2.0, -np.inf, np.inf, np.nan, 3e305, 2.5, -0.5])
    with running(engine) as under:
        kernel = s2sad.differentiate(logarithms, engine=under)
        found = s2sad.vjp(kernel, (x,), {"return": np.ones(x.size)})["x"]
        np.testing.assert_allclose(kernel.primal(x), sp.gammaln(x), rtol=1e-13)
    np.testing.assert_allclose(found, sp.digamma(x), rtol=1e-12)
