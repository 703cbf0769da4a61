"""Constants of dictionaries, objects and classes that a kernel's module holds: what was changed is seen."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.language.module_constants import CONFIG, MANY, PHYSICS, Physics, SETTINGS, SPACE, step
from tests.harness.derivatives import check_derivatives

ENGINES = ("numpy", "numba")


@pytest.mark.parametrize("engine", ENGINES)
def test_what_was_changed_is_seen(engine, monkeypatch):
    u, v = np.array([0.3, 0.6, 0.9, 1.2]), np.array([0.2, 0.7, 0.4, 0.5])
    gradient = s2sad.gradient(s2sad.differentiate(step, engine=engine), wrt="u")

    def expected():
        left = (1.0 - CONFIG["solver"]["relaxation"] * SPACE.damping) ** CONFIG["steps"]
        return np.array([left, left, left, 1.0]) * CONFIG["w"] * SPACE.inner.gravity / CONFIG["time scale"]

    np.testing.assert_allclose(gradient(u, v), expected(), rtol=1e-12)
    for holder, name, value in ((CONFIG["solver"], "relaxation", 0.4), (CONFIG, "steps", 3), (CONFIG, "w", 2.0 * u),
                                (CONFIG, "time scale", 2.0)):
        monkeypatch.setitem(holder, name, value)
        np.testing.assert_allclose(gradient(u, v), expected(), rtol=1e-12)
    for holder, name, value in ((SPACE, "damping", 0.5), (PHYSICS, "gravity", 1.62),
                                (SPACE, "inner", Physics(3.7, PHYSICS.weights))):
        monkeypatch.setattr(holder, name, value)
        np.testing.assert_allclose(gradient(u, v), expected(), rtol=1e-12)
    hides = s2sad.gradient(s2sad.differentiate(step, engine=engine), wrt="v")
    before = hides(u, v)
    monkeypatch.setattr(SETTINGS, "scale", 5.0, raising=False)   # the object's own hides its class's
    np.testing.assert_allclose(hides(u, v)[3], before[3])
    assert hides(u, v)[0] > 2.0 * before[0]


WEIGHTS = (1.0, -2.0, 1.0)
STAGES = [[0.0, 0.0], [0.5, 0], [0.25, 0.75]]
OFFSETS = [-1, 0, 1]
PAIRS = ((0.5, 2), (1.5, 1))


def numbers_of_sequences(u, v):
    for i in range(1, u.size - 1):
        for w, k in zip(WEIGHTS, OFFSETS):
            v[i] += w * u[i + k] ** 2
    for i, w in enumerate(WEIGHTS):
        for j in range(len(STAGES[0])):
            u[i] *= 1.0 + STAGES[i][j] * v[j] * w
    for a, k in PAIRS:
        u[int(k)] += a * v[0]
    return np.dot(WEIGHTS, u[1:]) * CONFIG["sequence"][-1]


@pytest.mark.parametrize("engine", ENGINES)
def test_numbers_of_tuples_and_lists(engine, monkeypatch):
    monkeypatch.setitem(CONFIG, "sequence", [2.0, 3.0])
    u, v = np.array([0.3, 0.6, 0.9, 1.2]), np.array([0.2, 0.7, 0.4, 0.5])
    check_derivatives(numbers_of_sequences, (u, v), ("u", "v"), ("u", "v", "return"), engine)
    gradient = s2sad.gradient(s2sad.differentiate(numbers_of_sequences, engine=engine), wrt="u")
    before = gradient(u, v)
    CONFIG["sequence"][1] = 6.0
    np.testing.assert_allclose(gradient(u, v), 2.0 * before, rtol=1e-12)
    STAGES[1][0] = 0.75
    changed = gradient(u, v)
    STAGES[1][0] = 0.5
    assert not np.allclose(changed, 2.0 * before)


def as_python_has_them(x):
    row = STAGES[1]
    return x[0] * row[0] + np.sum(x) * len(WEIGHTS * 2) + np.sum(x * PAIRS[0][0]) * MANY[x.size]


class Linear:
    def flux(self, u):
        return 2.0 * u


class Quadratic:
    def flux(self, u):
        return u * u


def first_part():
    def part(u):
        return u ** 3
    return part


def second_part():
    def part(u):
        return 5.0 * u
    return part


METHOD, ACTIVATION, MODEL, PART = "square", np.tanh, Linear(), first_part()


def of_what_is_named(x):
    kept = x[0] ** 2 if METHOD == "square" else x[0] ** 3
    return kept + ACTIVATION(x[1]) + MODEL.flux(x[2]) + PART(x[3])


@pytest.mark.parametrize("engine", ENGINES)
def test_what_a_name_means_may_change(engine, monkeypatch):
    x = np.array([0.6, 0.8, 1.2, 0.7])
    gradient = s2sad.gradient(s2sad.differentiate(of_what_is_named, engine=engine))
    expected = [1.2, 1.0 / np.cosh(0.8) ** 2, 2.0, 3.0 * 0.49]
    np.testing.assert_allclose(gradient(x), expected, rtol=1e-12)
    for k, (name, value, slope) in enumerate((("METHOD", "cube", 3.0 * 0.36), ("ACTIVATION", np.cos, -np.sin(0.8)),
                                              ("MODEL", Quadratic(), 2.4), ("PART", second_part(), 5.0))):
        monkeypatch.setitem(globals(), name, value)
        expected[k] = slope
        np.testing.assert_allclose(gradient(x), expected, rtol=1e-12)


square = lambda x: x * x  # noqa: E731


def misfit(u, observed, weight=2.0):
    total = 0.0
    for i in range(u.size):
        total += weight * square(u[i] - observed[i])
    return total


@pytest.mark.parametrize("engine", ENGINES)
def test_lambdas(engine):
    u, observed = np.zeros(3), np.array([1.0, 2.0, 3.0])

    def expected(factor):
        gradient = s2sad.gradient(s2sad.differentiate(lambda u: factor * misfit(u, observed), engine=engine))
        np.testing.assert_allclose(gradient(u), -4.0 * factor * observed, rtol=1e-14)

    expected(1.0)
    expected(3.0)


@pytest.mark.parametrize("engine", ENGINES)
def test_sequences_are_no_arrays(engine):
    gradient = s2sad.gradient(s2sad.differentiate(as_python_has_them, engine=engine))(np.ones(3))
    np.testing.assert_allclose(gradient, np.array([0.5, 0.0, 0.0]) + 6.0 + 0.5 * 3.0)
