"""Adjoints, tangents and residuals of the user's own, for functions that are read."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives

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
    text = s2sad.differentiate(helper, engine="numpy").adjoint_source(U, 0.5)
    assert "unread, kept = halved_forward(u, t)\n        kept_stack.append(kept)\n" in text
    assert "kept = kept_stack.pop()" in text


def test_what_is_kept_once_has_a_name():
    text = s2sad.differentiate(halved, engine="numpy").adjoint_source(U, 0.5)
    assert "    result, kept = halved_own_forward(u, t)\n" in text and "kept_stack" not in text
    text = s2sad.differentiate(helper, engine="numpy").adjoint_source(U, 0.5)
    assert "    kept_stack: what `halved(u, t)` keeps\n    kept_2: what `return halved(u, t)` keeps\n" in text
    told = str(s2sad.explain(helper, U, 0.5, engine="numpy"))
    assert "kept_stack: bytes known only at run time, what `halved(u, t)` keeps\n" in told
    assert s2sad.check(halved, U, 0.5, engine="numpy").with_differences


# -- functions that are not read ------------------------------------------------------------------------------------
def smoothed_adjoint(v, v_bar, u, u_bar, width):
    u_bar += np.convolve(v_bar, np.ones(width), "same") / width
    v_bar[:] = 0.0


@s2sad.rule(adjoint=smoothed_adjoint, writes="v")
def smoothed(v, u, width):
    v[:] = [float(x) for x in np.convolve(u, np.ones(width), "same") / width]


def norms_adjoint(u, u_bar, result_0_bar, result_1_bar):
    u_bar += u / np.linalg.norm(u) * result_0_bar + result_1_bar


def norms_tangent(u, u_dot):
    norm = float(np.linalg.norm(u))
    return norm, float(sum(u)), float(u @ u_dot) / norm, float(sum(u_dot))


@s2sad.rule(adjoint=norms_adjoint, tangent=norms_tangent, returns=2)
def norms(u):
    return float(np.linalg.norm(u)), float(sum(list(u)))


def bare_system(r, x, p):
    r[:] = x ** 3 + p * x - 1.0


@s2sad.rule(implicit=bare_system, writes="x")
def solved(x, p):
    try:
        for _ in range(100):
            x -= (x ** 3 + p * x - 1.0) / (3.0 * x * x + p)
    except ArithmeticError:
        pass


def of_what_is_not_read(u, p):
    v = np.zeros(u.size)
    smoothed(v, u, 3)
    solved(p, v)
    u[:] = v * p
    a, b = norms(u)
    return a * b


def test_functions_that_are_not_read():
    u = np.array([0.3, 0.5, 0.7])
    report = s2sad.check(of_what_is_not_read, u, P, engine="numpy")
    assert report and report.with_differences
    check_derivatives(norms, (u,), ("u",), ("return",))
    check_derivatives(solved, (P, u), ("x", "p"), ("x",))


def test_check_compares_with_differences_and_names_what_parts():
    report = s2sad.check(takes_wrong, U, engine="numpy")
    assert str(report).splitlines()[1:] == [
        "  adjoint with differences (dot product): PARTS, apart by 3.3e-01, 1e-06 allowed",
        f"  adjoints of the user's own, without tangents: {__name__}.wrong_adjoint"]
    report = s2sad.check(takes_wrong_too, U, engine="numpy")
    assert str(report).endswith(": return wrong_too(u) * 2.0") and not report.adjoint_holds and report.tangent_holds


def wrong_adjoint(u, u_bar, result_bar):
    u_bar += 4.0 * u * result_bar


def right_tangent(u, u_dot):
    return np.sum(u * u), 2.0 * np.sum(u * u_dot)


@s2sad.rule(adjoint=wrong_adjoint)
def wrong(u):
    return np.sum(u * u)


@s2sad.rule(adjoint=wrong_adjoint, tangent=right_tangent)
def wrong_too(u):
    return np.sum(u * u)


def takes_wrong(u):
    return wrong(u) * 2.0


def takes_wrong_too(u):
    return wrong_too(u) * 2.0
