"""Adjoints, tangents and residuals of the user's own, for functions that are read."""
from __future__ import annotations


import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives

ENGINES = ("numpy", "numba")
U, P = np.array([0.3, -0.5, 0.7]), np.array([1.1, 0.8, 0.9])


# -- an adjoint and a tangent ---------------------------------------------------------------------------------------
def scaled_adjoint(u, u_bar, p, p_bar, t, n, result_bar):
    """Overwrites u as it goes, as the function does."""
    t_bar = 0.0
    for i in range(n):
        seed = u_bar[i] + result_bar
        t_bar += u[i] * p[i] * seed
        p_bar[i] += u[i] * t * seed
        u_bar[i] = p[i] * t * seed
        u[i] = -7.0
    return t_bar


def scaled_tangent(u, u_dot, p, p_dot, t, t_dot, n):
    s = s_dot = 0.0
    for i in range(n):
        u_dot[i] = u_dot[i] * p[i] * t + u[i] * p_dot[i] * t + u[i] * p[i] * t_dot
        u[i] *= p[i] * t
        s += u[i]
        s_dot += u_dot[i]
    return s, s_dot


@s2sad.rule(adjoint=scaled_adjoint, tangent=scaled_tangent)
def scaled(u, p, t, n):
    s = 0.0
    for i in range(n):
        u[i] *= p[i] * t
        s += u[i]
    return s


def both_adjoint(x, y, k, result_0_bar, result_2_bar):
    return y * result_0_bar + result_2_bar, x * result_0_bar + k * result_2_bar


def both_tangent(x, x_dot, y, y_dot, k):
    return x * y, k, x + k * y, x * y_dot + y * x_dot, x_dot + k * y_dot


@s2sad.rule(adjoint=both_adjoint, tangent=both_tangent)
def both(x, y, k):
    return x * y, k, x + k * y


def within(x, y):
    a, k, b = both(x, y, 3)
    return a * b + k


def in_loops_and_branches(u, p, t):
    total = 0.0
    for k in range(2):
        total += scaled(u, p, t * k + total + 0.8, 3)
        if total > 0.1:
            scaled(u[1:], p[:-1], 1.3, 2)
        total *= 0.5 * total + within(total, u[k])
        while total > 1.0:
            total = 0.2 * scaled(u, p, 0.9, 3) + 0.5 * np.abs(total)
        a, _, b = both(u[0], total, k)
        u[2] += a * b
    return total


@pytest.mark.parametrize("engine", ENGINES)
def test_an_adjoint_and_a_tangent(engine):
    check_derivatives(in_loops_and_branches, (U, P, 0.7), ("u", "p", "t"), ("u", "return"), engine)


def test_a_subset_and_the_function_itself():
    check_derivatives(scaled, (U, P, 0.7, 3), ("u", "p", "t"), ("u", "return"))
    check_derivatives(scaled, (U, P, 0.7, 2), ("p",), ("return",))
    check_derivatives(scaled, (U, P, 0.7, 2), ("u",), ("return",))
    check_derivatives(scaled, (U.astype("float32"), P.astype("float32"), 0.7, 3), ("u", "t"), ("u",))
    check_derivatives(both, (0.4, 0.7, 2), ("x", "y"), ("return",))
    assert s2sad.check(scaled, U, P, 0.7, 3, engine="numpy")


def flat_part(x):
    return np.floor(3.0 * x)


def straight_adjoint(x, result_bar):
    return 3.0 * result_bar


s2sad.rule(flat_part, adjoint=straight_adjoint)


def through_steps(u):
    return flat_part(u[0]) * u[1]


def test_a_derivative_that_the_text_does_not_have():
    found = s2sad.gradient(s2sad.differentiate(through_steps, engine="numpy"))(np.array([0.5, 2.0]))
    np.testing.assert_array_equal(found, [6.0, 1.0])


# -- an adjoint in two halves ---------------------------------------------------------------------------------------
CALLS = {"first": 0}


def halved_forward(u, t):
    kept = u.copy()
    s = 0.0
    for i in range(u.size):
        u[i] = np.sin(u[i]) * t
        s += u[i]
    return s, (kept, s)


def halved_reverse(kept, u, u_bar, t, result_bar):
    before, s = kept
    t_bar = 0.0
    for i in range(u_bar.size):
        seed = u_bar[i] + result_bar
        t_bar += np.sin(before[i]) * seed
        u_bar[i] = np.cos(before[i]) * t * seed
    return t_bar + 0.0 * s


@s2sad.rule(forward=halved_forward, reverse=halved_reverse)
def halved(u, t):
    s = 0.0
    for i in range(u.size):
        u[i] = np.sin(u[i]) * t
        s += u[i]
    return s


def filled_forward(v, u):
    v[:] = u * u
    return u.copy()


def filled_reverse(kept, v, v_bar, u, u_bar):
    u_bar += 2.0 * kept * v_bar
    v_bar[:] = 0.0


@s2sad.rule(forward=filled_forward, reverse=filled_reverse)
def filled(v, u):
    v[:] = u * u


def helper(u, t):
    if u[0] > 0.0:
        halved(u, t)
    return halved(u, t)


def with_halves(u, v, t):
    total = 0.0
    for k in range(2):
        total += helper(u, t * k + 0.9 + total)
        while total < 1.0:
            total += halved(u[:2], 0.2 + t) + 0.6
        filled(v, u)
        u[:] = v * 0.3 + u
        total *= total * 0.5
    return total


def plainly(u, v, t):
    """`with_halves` without rules."""
    total = 0.0
    for k in range(2):
        for _ in range(2 if u[0] > 0.0 else 1):
            u[:] = np.sin(u) * (t * k + 0.9 + total)
        total += np.sum(u)
        while total < 1.0:
            u[:2] = np.sin(u[:2]) * (0.2 + t)
            total += np.sum(u[:2]) + 0.6
        v[:] = u * u
        u[:] = v * 0.3 + u
        total *= total * 0.5
    return total


@pytest.mark.parametrize("engine", ENGINES)
def test_an_adjoint_in_two_halves(engine):
    given, seeds = (np.array([0.4, 0.3]), np.zeros(2), 0.7), {"u": np.array([1.0, -2.0]), "return": 0.7}
    found = s2sad.vjp(s2sad.differentiate(with_halves, engine=engine), given, seeds)
    expected = s2sad.vjp(s2sad.differentiate(plainly, engine="numpy"), given, seeds)
    for name, gradient in expected.items():
        np.testing.assert_allclose(found[name], gradient, rtol=1e-13)


def test_what_is_kept_lies_on_a_list():
    text = s2sad.differentiate(halved, engine="numpy").adjoint_source(U, 0.5)
    assert "    result, kept = halved_own_forward(u, t)\n    kept_stack.append(kept)\n" in text
    assert "kept = kept_stack.pop()" in text
    assert s2sad.check(halved, U, 0.5, engine="numpy").with_differences


# -- implicit functions ---------------------------------------------------------------------------------------------
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


@pytest.mark.parametrize("engine", ENGINES)
def test_implicit_functions(engine):
    x = np.array([0.5, 0.6, 0.7])
    check_derivatives(roots, (np.array([0.3, 0.5, 0.7]), 0.4), ("u", "a"), ("u", "return"), engine)
    check_derivatives(several, (x, P, 0.4), ("x", "p", "t"), ("x", "return"), engine)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_solver_without_a_matrix(engine):
    x, b = np.zeros((2, 3)), np.array([[1.0, 2.0, 3.0], [-1.0, 0.5, 0.0]])
    check_derivatives(diffused, (x, P, b), ("x", "p", "b"), ("x",), engine)


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
