"""Functions that are held fixed: numbers to the derivative, called as they are."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.custom.test_user_rules import ENGINES

# -- held fixed -----------------------------------------------------------------------------------------------------
@s2sad.nondifferentiable
def size_of(u):
    return abs(u[0]) + 1.0


@s2sad.nondifferentiable(result="int")
def cell(x):
    return int(x * 3.0)


@s2sad.nondifferentiable
def unreadable(x):
    return float(f"{x:.17g}")


def holds(u):
    scale = size_of(u)
    total = 0.0
    for i in range(u.size):
        k = cell(u[i]) % u.size
        total += scale * u[i] * u[k]
        u[i] = total
    return total


def holds_unreadable(u):
    total = 0.0
    for i in range(u.size):
        total += unreadable(u[i]) * u[i]
    return total


def held_by_hand(u, scale):
    total = 0.0
    for i in range(u.size):
        k = int(u[i] * 3.0) % u.size
        total += scale * u[i] * u[k]
        u[i] = total
    return total


@pytest.mark.parametrize("engine", ENGINES)
def test_a_function_that_is_held_fixed_is_a_number(engine):
    u, seeds = np.array([0.3, 0.9, 1.2]), {"return": 1.0, "u": np.array([0.5, -1.0, 2.0])}
    ours = s2sad.differentiate(holds, engine=engine)
    by_hand = s2sad.differentiate(held_by_hand, engine=engine)
    scale = size_of(u)
    got = s2sad.vjp(ours, (u,), seeds, wrt="u")["u"]
    np.testing.assert_allclose(got, s2sad.vjp(by_hand, (u, scale), seeds, wrt="u")["u"], rtol=1e-14)
    x_dot = {"u": np.array([1.0, -0.5, 0.25])}
    got, expected = s2sad.jvp(ours, (u,), x_dot), s2sad.jvp(by_hand, (u, scale), x_dot)
    np.testing.assert_allclose(got["u"], expected["u"], rtol=1e-14)
    np.testing.assert_allclose(got["return"], expected["return"], rtol=1e-14)


def test_any_python_function_can_be_held_fixed_under_numpy():
    u = np.array([0.3, 0.9])
    np.testing.assert_array_equal(s2sad.gradient(s2sad.differentiate(holds_unreadable, engine="numpy"))(u), u)


def test_what_numba_cannot_compile_is_refused_at_the_call():
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(holds_unreadable, engine="numba"))(np.array([0.3, 0.9]))
    assert str(caught.value).partition("error")[2] == (
        f"[S407]: Numba cannot compile '{__name__}.unreadable'\n"
        "  39 |         total += unreadable(u[i]) * u[i]\n"
        "     |                  ^^^^^^^^^^^^^^^^\n"
        '  help: engine="numpy" calls it as it is')


def within_a_whole_array(u, v):
    v[:] = u * size_of(u)


def in_a_statement_of_its_own(u, v):
    scale = size_of(u)
    v[:] = u * scale


@pytest.mark.parametrize("engine", ENGINES)
def test_an_array_goes_to_a_function_as_a_whole(engine):
    u = np.array([-2.0, 0.5])
    with pytest.raises(s2sad.S2sadError, match="not called with an array in a whole-array expression"):
        s2sad.vjp(s2sad.differentiate(within_a_whole_array, engine=engine), (u, u.copy()), {"v": u})
    found = s2sad.vjp(s2sad.differentiate(in_a_statement_of_its_own, engine=engine), (u, u.copy()), {"v": u})
    np.testing.assert_array_equal(found["u"], 3.0 * u)


def times_median(a):
    return a[0, 0] * np.nanmedian(a)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_function_of_a_library_is_held_fixed(engine):
    a = np.array([[2.0, 1.0], [0.5, 3.0]])
    found = s2sad.gradient(s2sad.differentiate(times_median, engine=engine))(a)
    np.testing.assert_allclose(found, [[np.nanmedian(a), 0.0], [0.0, 0.0]], rtol=1e-13)


@s2sad.nondifferentiable
def no_number(u):
    return u * 2.0


def takes_no_number(u):
    return no_number(u) * u[0]


@pytest.mark.parametrize(("engine", "kind", "message"), [
    ("numpy", TypeError, "no_number is held fixed by .* but returned array"),
    ("numba", s2sad.S2sadError, "Numba cannot compile")])
def test_a_result_that_is_no_number_is_refused(engine, kind, message):
    with pytest.raises(kind, match=message):
        s2sad.gradient(s2sad.differentiate(takes_no_number, engine=engine))(np.ones(2))


def test_check_says_what_is_held_fixed():
    report = s2sad.check(in_a_statement_of_its_own, np.array([-2.0, 0.5]), np.zeros(2), engine="numpy")
    assert str(report).endswith("\n  held fixed by s2sad.nondifferentiable, which differences do not do: "
                                f"{__name__}.size_of")
