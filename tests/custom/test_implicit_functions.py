"""Implicit functions: the derivative of what a solver finds, by the condition that it meets."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from s2sad.run.compiled import _runtime
from tests.custom.test_user_adjoints import ENGINES, P
from tests.harness.derivatives import check_derivatives


def cubic(x, a, b):
    return x * x * x + a * x - b


@s2sad.rule(implicit=cubic)
def root(x, a, b, most):
    steps = 0
    while abs(cubic(x, a, b)) > 1e-14 and steps < most:
        x -= cubic(x, a, b) / (3.0 * x * x + a)
        steps += 1
    return x, steps


def roots(u, a):
    total, x = 0.0, 1.0
    for i in range(u.size):
        x, steps = root(x, a, u[i] + total, 50)
        total += x * x + 0.0 * steps
        u[i] *= x
    return total


SHIFT = np.array([0.1, -0.2, 0.3])


def coupled(r, x, p, t):
    for i in range(x.size):
        r[i] = x[i] ** 3 + p[i] * x[i] - t - SHIFT[i]
    for i in range(1, x.size):
        r[i] += 0.3 * x[i - 1] * p[i]


def newton_steps(x, p, t):
    """Newton's method, as the user writes it."""
    n = x.size
    r, jacobian = np.zeros(n), np.zeros((n, n))
    for _ in range(30):
        coupled(r, x, p, t)
        for i in range(n):
            jacobian[i, i] = 3.0 * x[i] ** 2 + p[i]
            if i:
                jacobian[i, i - 1] = 0.3 * p[i]
        x[:] = x - np.linalg.solve(jacobian, r)


@s2sad.rule(implicit=coupled)
def newton(x, p, t):
    newton_steps(x, p, t)


@s2sad.rule(implicit=coupled, solver="gmres")
def newton_by_gmres(x, p, t):
    newton_steps(x, p, t)


def richardson(product, b, operands):
    x = np.zeros(b.shape)
    for _ in range(400):
        x = x + 0.2 * (b - product(x, operands))
    return x


@s2sad.rule(implicit=coupled, solver=richardson)
def newton_by_hand(x, p, t):
    newton_steps(x, p, t)


def laplace(r, x, p, b):
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            r[i, j] = (2.0 + p[j]) * x[i, j] - b[i, j]
            if j:
                r[i, j] -= p[j] * p[j - 1] * x[i, j - 1]
                r[i, j - 1] -= p[j] * p[j - 1] * x[i, j]


def conjugate_gradients(x, p, b):
    """A linear system, solved without its matrix by the user's own code."""
    r, q = np.zeros(x.shape), np.zeros(x.shape)
    nothing = np.zeros(x.shape)
    laplace(r, x, p, b)
    d = -r
    square = np.sum(r * r)
    for _ in range(4 * x.size):
        laplace(q, d, p, nothing)
        step = square / np.sum(d * q)
        x[:] = x + step * d
        r[:] = r + step * q
        before = square
        square = np.sum(r * r)
        if square < 1e-30:
            break
        d[:] = square / before * d - r


@s2sad.rule(implicit=laplace, solver="cg")
def diffused(x, p, b):
    conjugate_gradients(x, p, b)


def several(x, p, t):
    total = 0.0
    for k in range(2):
        newton(x, p, t + total)
        total += np.sum(x * x)
        x[:] = x * p
        newton_by_gmres(x, p, 0.3 * total)
        total += x[k]
    newton_by_hand(x[:2], p[:2], total)
    return total


def test_implicit_functions():
    x, b = np.array([0.5, 0.6, 0.7]), np.array([[1.0, 2.0, 3.0], [-1.0, 0.5, 0.0]])
    check_derivatives(roots, (np.array([0.3, 0.5, 0.7]), 0.4), ("u", "a"), ("u", "return"))
    check_derivatives(several, (x, P, 0.4), ("x", "p", "t"), ("x", "return"))
    check_derivatives(diffused, (0.0 * b, P, b), ("x", "p", "b"), ("x",))


@s2sad.rule(implicit=coupled)
def relaxed(x, p, t):
    for _ in range(80):
        for i in range(x.size):
            r = x[i] ** 3 + p[i] * x[i] - t - SHIFT[i]
            if i:
                r += 0.3 * x[i - 1] * p[i]
            x[i] -= r / (3.0 * x[i] ** 2 + p[i])


def compiled_too(x, p, t):
    total, steps = root(1.0, 0.4, t, 50)
    for _ in range(2):
        relaxed(x, p, t + total)
        total += 0.05 * np.sum(x * x) + 0.01 * steps
    return total


def test_implicit_functions_are_compiled():
    pytest.importorskip("numba")
    given, seeds = (np.array([0.5, 0.6, 0.7]), P, 0.4), {"x": np.array([1.0, -1.0, 2.0]), "return": 0.7}
    found, expected = (s2sad.vjp(s2sad.differentiate(compiled_too, engine=e), given, seeds) for e in ENGINES)
    for name, gradient in expected.items():
        np.testing.assert_allclose(found[name], gradient, rtol=1e-12, atol=1e-14)


def test_solvers_without_a_matrix_are_compiled():
    numba = pytest.importorskip("numba")
    product = numba.njit(lambda v, operands: np.dot(operands[0], v))
    matrix, b = np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([1.0, -3.0])
    solvers = _runtime("s2sad.runtime.systems", True)

    @numba.njit
    def both_ways(matrix, b):
        return cg(product, b, (matrix,)), gmres(product, b, (matrix,))
    cg, gmres = solvers["cg"], solvers["gmres"]
    for found in both_ways(matrix, b):
        np.testing.assert_allclose(matrix @ found, b, rtol=1e-14)


def test_the_iteration_has_the_same_derivative():
    seeds = {"x": np.array([1.0, -1.0, 2.0])}
    given = (np.array([0.5, 0.6, 0.7]), P, 0.4)
    ours = s2sad.vjp(s2sad.differentiate(newton, engine="numpy"), given, seeds)
    through = s2sad.vjp(s2sad.differentiate(newton_steps, engine="numpy"), given, seeds)
    np.testing.assert_array_equal(ours["x"], 0.0)
    np.testing.assert_allclose(through["x"], 0.0, atol=1e-15)
    for name in "pt":
        np.testing.assert_allclose(ours[name], through[name], rtol=1e-13)
    b = np.array([[1.0, 2.0, 3.0]])
    ours = s2sad.vjp(s2sad.differentiate(diffused, engine="numpy"), (0.0 * b, P, b), {"x": b})
    through = s2sad.vjp(s2sad.differentiate(conjugate_gradients, engine="numpy"), (0.0 * b, P, b), {"x": b})
    for name in "pb":
        np.testing.assert_allclose(ours[name], through[name], rtol=1e-12)
