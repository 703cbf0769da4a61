"""Kernels as functions of CasADi's: values, sparse Jacobians, and an optimization through a kernel."""
from __future__ import annotations

import casadi
import numpy as np
import pytest

import s2sad
from tests.bridges import kernels
from tests.jacobians.kernels import upwind

U, RATE = np.array([1.0, -0.5, 0.3, 2.0]), 0.4


def bridged(f, args, **options):
    return s2sad.casadi(s2sad.differentiate(f, engine="numpy"), args, **options)


def relaxed(u, rate):
    u = np.array(u)
    kernels.relax(u, rate)
    return u


def test_values_and_jacobians():
    k, x, r = bridged(kernels.relax, (U, RATE)), casadi.MX.sym("x", 4), casadi.MX.sym("r")
    np.testing.assert_array_equal(k(U, RATE).full()[:, 0], relaxed(U, RATE))
    assert (k.name_in(), k.name_out()) == (["u", "rate"], ["u_out"])
    found = casadi.Function("J", [x, r], [casadi.jacobian(k(x, r), x), casadi.jacobian(k(x, r), r)])(U + 1.0, 0.7)
    for block, name in zip(found, ("u", "rate")):
        wanted = s2sad.jacobian(kernels.relax, name)(U + 1.0, 0.7)
        np.testing.assert_allclose(block.full(), wanted.reshape(4, -1), rtol=1e-14)
    plan = s2sad.jacobian(s2sad.differentiate(kernels.relax, engine="numpy"), "u", sparse=True).plan(U, RATE)
    assert found[0].nnz() == len(plan.indices) < 16
    slope = casadi.Function("g", [r], [casadi.gradient(casadi.sumsqr(k(U, r)), r)])(RATE)
    difference = (np.sum(relaxed(U, RATE + 1e-6) ** 2) - np.sum(relaxed(U, RATE - 1e-6) ** 2)) / 2e-6
    np.testing.assert_allclose(float(slope), difference, rtol=1e-8)


def test_matrices_go_by_columns():
    x = np.arange(1.0, 7.0).reshape(2, 3)
    k, s = bridged(kernels.turned, (x,)), casadi.MX.sym("s", 2, 3)
    np.testing.assert_array_equal(k(x).full(), kernels.turned(x))
    same = casadi.vertcat(*[casadi.horzcat(*[s[i, j] ** 2 * (i + 1) for i in range(2)]) for j in range(3)])
    ours, theirs = (casadi.Function("J", [s], [casadi.jacobian(e, s)])(x) for e in (k(s), same))
    np.testing.assert_allclose(ours.full(), theirs.full(), rtol=1e-14)


@pytest.mark.parametrize("f, args, said", [
    (kernels.several, (U, np.zeros(4), 2.0), "error[S401]: 'several' returns several values\n  help: write a function "
     "that returns the one that is meant, or name what it writes: of=..."),
    (kernels.squared, (np.ones((2, 2, 2)),), "error[S405]: 'x' of 'squared' has 3 axes, and a matrix of CasADi's has "
     "two\n  help: write a function that takes it with two, and reshapes it"),
    (kernels.rotated, (np.ones(2, complex), 1.0), "error[S401]: 'z' of 'rotated' is complex, and a complex number has "
     "two directions\n  help: write a function of real and imaginary parts")])
def test_what_casadi_does_not_take(f, args, said):
    with pytest.raises(s2sad.S2sadError) as caught:
        bridged(f, args)
    assert str(caught.value) == said


def test_what_is_raised_is_an_error_of_casadi():
    with pytest.raises(RuntimeError, match="a root of less than zero"):
        bridged(kernels.root, (4.0,))(-1.0)
    x = casadi.MX.sym("x", 4)
    k = bridged(upwind, (np.zeros(4), np.ones(4)), wrt="u", of="du")
    J = casadi.Function("J", [x], [casadi.jacobian(k(x), x)])
    np.testing.assert_allclose(J(2.0 * np.ones(4)).full(), s2sad.jacobian(upwind, "u", "du")(
        np.zeros(4), 2.0 * np.ones(4)))
    with pytest.raises(RuntimeError, match="the pattern of the Jacobian of 'upwind' lacks entries"):
        J(-np.ones(4))


def test_a_network_and_a_kernel_train_together():
    """A network gives a start, the kernel smooths it in place; gradient steps go through both."""
    n, x = 8, np.linspace(0.0, 1.0, 8)
    k, target = bridged(kernels.relax, (np.zeros(n), 0.7), wrt="u"), relaxed(np.sin(3.0 * x), 0.7)
    w = casadi.MX.sym("w", 12)
    start = casadi.tanh(casadi.DM(x) @ w[:4].T + casadi.repmat(w[4:8].T, n, 1)) @ w[8:]
    loss = casadi.sumsqr(k(start) - target) / n
    step = casadi.Function("step", [w], [loss, casadi.gradient(loss, w)])
    weights, losses = np.random.default_rng(0).normal(size=12), []
    for _ in range(600):
        value, slope = step(weights)
        losses.append(float(value))
        weights -= 0.3 * slope.full()[:, 0]
    assert losses[-1] < 0.2 * losses[0]
