"""The instrument itself: it accepts right derivatives, finds each kind of wrong one, and knows a kink."""
from __future__ import annotations

import math

import numpy as np
import pytest

from tests.harness import derivatives
from tests.harness.derivatives import VectorFunction, UnreliableDifferences, check_derivatives, differences
from tests.harness.seeds import generator


def kernel(u, c):
    total = 0.0
    for i in range(u.size):
        u[i] = c * math.sin(u[i])
        total += u[i]
    return total


def vjp(f, args, seeds, wrt):
    u, c = args
    bar = seeds["u"] + seeds["return"]
    return {"u": c * np.cos(u) * bar, "c": float(np.sum(np.sin(u) * bar))}


def jvp(f, args, tangents, of):
    u, c = args
    u_dot = tangents["c"] * np.sin(u) + c * np.cos(u) * tangents["u"]
    return {"u": u_dot, "return": float(u_dot.sum())}


class Stub:
    """Stands for the package under test, with derivatives written by hand."""
    S2sadWarning = UserWarning
    vjp, jvp = staticmethod(vjp), staticmethod(jvp)

    @staticmethod
    def differentiate(f, engine):
        return f


def checked(monkeypatch, **wrong):
    monkeypatch.setattr(derivatives, "s2sad", type("Wrong", (Stub,), {k: staticmethod(v) for k, v in wrong.items()}))
    return check_derivatives(kernel, (np.array([0.3, -0.7, 1.1]), 1.3), ("u", "c"), ("u", "return"))


def test_accepts_what_is_right(monkeypatch):
    measured = checked(monkeypatch)
    assert measured.dot_product < 1e-14
    assert measured.directional < 1e-9
    assert measured.coordinates < 1e-9


def test_finds_a_wrong_adjoint(monkeypatch):
    with pytest.raises(AssertionError, match="dot product"):
        checked(monkeypatch, vjp=lambda *a, **k: {**vjp(*a, **k), "c": vjp(*a, **k)["c"] * (1 + 1e-9)})


def test_finds_adjoint_and_tangent_wrong_alike(monkeypatch):
    def wrong_vjp(f, args, seeds, wrt):
        return {n: 1.001 * g for n, g in vjp(f, args, seeds, wrt).items()}

    def wrong_jvp(f, args, tangents, of):
        return {n: 1.001 * g for n, g in jvp(f, args, tangents, of).items()}
    with pytest.raises(AssertionError, match="tangent of output 0"):
        checked(monkeypatch, vjp=wrong_vjp, jvp=wrong_jvp)


def test_finds_one_partial_wrong_in_the_sixth_digit(monkeypatch):
    """Of the adjoint and the tangent alike, so that the dot product says nothing."""
    def wrong_vjp(f, args, seeds, wrt):
        right = vjp(f, args, seeds, wrt)
        return {**right, "c": right["c"] * (1 + 1e-6)}

    def wrong_jvp(f, args, tangents, of):
        return jvp(f, args, {**tangents, "c": tangents["c"] * (1 + 1e-6)}, of)
    with pytest.raises(AssertionError, match="differences have"):
        checked(monkeypatch, vjp=wrong_vjp, jvp=wrong_jvp)


def test_finds_changed_arguments(monkeypatch):
    def careless(f, args, seeds, wrt):
        found = vjp(f, args, seeds, wrt)
        args[0][1] += 1.0
        return found
    with pytest.raises(AssertionError, match="vjp changed argument 0"):
        checked(monkeypatch, vjp=careless)


def test_finds_a_wrong_shape(monkeypatch):
    with pytest.raises(AssertionError, match=r"gradient of u: shape \(3, 1\), not \(3,\)"):
        checked(monkeypatch, vjp=lambda *a, **k: {**vjp(*a, **k), "u": np.zeros((3, 1))})


def absolute(u):
    return abs(u[0])


def jump(u):
    return 1.0 if u[0] > 0.0 else 0.0


@pytest.mark.parametrize(("function", "at"), [(absolute, 0.0), (absolute, 1e-7), (jump, 0.0), (jump, 1e-12)])
def test_knows_a_kink(function, at, monkeypatch):
    subject = VectorFunction(function, (np.array([at, 1.0]),), ("u",), ("return",))
    _, error = differences(subject, np.array([1.0, 0.0]))
    assert error[0] > 1e-4


def test_raises_at_a_kink(monkeypatch):
    monkeypatch.setattr(derivatives, "s2sad", type("At", (Stub,), {
        "vjp": staticmethod(lambda f, args, seeds, wrt: {"u": np.zeros(1)}),
        "jvp": staticmethod(lambda f, args, tangents, of: {"return": 0.0})}))
    with pytest.raises(UnreliableDifferences):
        check_derivatives(absolute, (np.zeros(1),), ("u",), ("return",))


@pytest.mark.parametrize(("function", "slope", "at"), [
    (lambda u: math.exp(30.0 * u[0]), 30.0 * math.exp(9.0), 0.3), (lambda u: u[0] ** 9, 9.0, 1.0),
    (lambda u: math.sin(50.0 * u[0]), 50.0 * math.cos(10.0), 0.2), (lambda u: 1e-9 * u[0], 1e-9, 3.0)])
def test_differences_are_as_good_as_they_say(function, slope, at):
    subject = VectorFunction(function, (np.array([at]),), ("u",), ("return",))
    found, error = differences(subject, np.array([1.0]))
    assert abs(found[0] - slope) <= 20 * error[0]
    assert error[0] < 1e-8 * abs(slope)


def nearly_singular(condition, size, random):
    left, right = (np.linalg.qr(random.standard_normal((size, size)))[0] for _ in range(2))
    return left @ np.diag(np.geomspace(1.0, 1.0 / condition, size)) @ right


def solved(a, b):
    return np.linalg.solve(a, b)


def solved_apart(condition, random, wrong=0.0, size=4):
    """How far a derivative of a solve is from its differences, as multiples of their estimated errors."""
    a = nearly_singular(condition, size, random)
    b = a @ random.standard_normal(size)
    subject = VectorFunction(solved, (a, b), ("a",), ("return",))
    direction = random.standard_normal(a.shape) * np.abs(a)
    if random.random() < 0.5:
        direction *= (np.arange(a.size) == random.integers(a.size)).reshape(a.shape)
    exact = -np.linalg.solve(a, direction @ np.linalg.solve(a, b))
    found, error = differences(subject, direction.ravel())
    return np.abs(found - exact * (1.0 + wrong)) / error, error / np.abs(exact).max()


@pytest.mark.parametrize("condition", (1e1, 1e3, 3e4))
def test_differences_know_what_a_solve_does_to_rounding(condition):
    random = generator(12)
    apart = np.concatenate([solved_apart(condition, random)[0] for _ in range(60)])
    assert apart.max() < 10.0, f"{np.sum(apart >= 10.0)} of {apart.size}, the worst {apart.max():.0f} times"


@pytest.mark.parametrize("condition", (1e1, 1e3))
def test_what_a_solve_does_to_rounding_hides_no_sixth_digit(condition):
    random = generator(12)
    cases = [solved_apart(condition, random, wrong=1e-6) for _ in range(60)]
    assert np.mean([apart.max() > 10.0 for apart, _ in cases]) > 0.9
    assert np.mean([error.max() < 1e-8 for _, error in cases]) > 0.9


def narrow(u):
    return u[0] + 1e-6 * math.atan((u[0] - 2.0) / 1e-7)


def test_differences_see_what_is_narrower_than_their_steps():
    """The steps say 1, as if there were nothing; the slope is 11."""
    subject = VectorFunction(narrow, (np.array([2.0]),), ("u",), ("return",))
    _, error = differences(subject, np.array([1.0]))
    assert error[0] > 1.0


def stairs(u):
    return np.float64(np.float32(u[0])) * u[0]


def test_differences_know_what_single_precision_within_does():
    subject = VectorFunction(stairs, (np.array([0.7]),), ("u",), ("return",))
    found, error = differences(subject, np.array([1.0]))
    assert abs(found[0] - 1.4) < 10 * error[0] < 1e-2


@pytest.mark.parametrize(("function", "slope"), [(lambda u: 1.4 * u[0], 1.4), (lambda u: u[0] + 1e3 * u[0] ** 3, 1.0),
                                                 (lambda u: u[0] ** 3, 0.0)])
def test_differences_hold_where_the_value_is_zero(function, slope):
    """There is no rounding to measure."""
    subject = VectorFunction(function, (np.array([0.0]),), ("u",), ("return",))
    found, error = differences(subject, np.array([0.97]))
    assert abs(found[0] - 0.97 * slope) <= 10 * error[0] + 1e-14
    assert error[0] < 1e-10
