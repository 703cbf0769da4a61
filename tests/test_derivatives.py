"""The instrument itself: it accepts right derivatives, finds each kind of wrong one, and knows a kink."""
from __future__ import annotations

import math

import numpy as np
import pytest

from tests import derivatives
from tests.derivatives import Subject, UnreliableDifferences, check_derivatives, differences


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
    subject = Subject(function, (np.array([at, 1.0]),), ("u",), ("return",))
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
    subject = Subject(function, (np.array([at]),), ("u",), ("return",))
    found, error = differences(subject, np.array([1.0]))
    assert abs(found[0] - slope) <= 20 * error[0]
    assert error[0] < 1e-8 * abs(slope)
