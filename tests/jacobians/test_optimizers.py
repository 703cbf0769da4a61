"""SciPy's optimizers take gradients, Jacobians and products with Hessians as they are."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.engines import running
from tests.jacobians import kernels


def residuals(x, k):
    """A chain whose neighbours should be k apart, and an end that is held."""
    out = np.empty(x.size)
    out[0] = x[0] - 1.0
    for i in range(1, x.size):
        out[i] = (x[i] - x[i - 1]) ** 3 + x[i] - x[i - 1] - k
    return out


START = np.linspace(0.0, 1.0, 8)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("sparse", [False, True])
def test_least_squares(engine, sparse):
    optimize = pytest.importorskip("scipy.optimize")
    with running(engine) as run_under:
        J = s2sad.jacobian(s2sad.differentiate(residuals, engine=run_under), "x", sparse=sparse)
        for bounds in ((-np.inf, np.inf), (0.0, 30.0)):
            found = optimize.least_squares(residuals, START, jac=J, args=(2.0,), bounds=bounds)
            assert found.success
            np.testing.assert_allclose(found.x, 1.0 + np.arange(8.0), atol=1e-6)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("method", ["hybr", "lm"])
def test_root(engine, method):
    optimize = pytest.importorskip("scipy.optimize")
    with running(engine) as run_under:
        J = s2sad.jacobian(s2sad.differentiate(residuals, engine=run_under), "x")
        found = optimize.root(residuals, START, jac=J, args=(2.0,), method=method)
    assert found.success
    np.testing.assert_allclose(found.x, 1.0 + np.arange(8.0), atol=1e-8)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("method", ["Newton-CG", "trust-ncg", "trust-krylov", "trust-constr"])
def test_minimize_with_products(engine, method):
    optimize = pytest.importorskip("scipy.optimize")
    with running(engine) as run_under:
        f = s2sad.differentiate(kernels.energy, engine=run_under)
        found = optimize.minimize(kernels.energy, START, args=(0.5,), jac=s2sad.gradient(f, "x"), method=method,
                                  hessp=lambda x, v, k: s2sad.hvp(f, (x, k), {"x": v}))
        assert np.abs(s2sad.gradient(f, "x")(found.x, 0.5)).max() < 1e-4
        exact = optimize.minimize(kernels.energy, START, args=(0.5,), jac=s2sad.gradient(f, "x"), method="trust-exact",
                                  hess=s2sad.hessian(f, "x"))
    assert abs(exact.fun - found.fun) < 1e-6
