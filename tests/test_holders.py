"""Constants of dictionaries, objects and classes that a kernel's module holds."""
from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

import s2sad
from tests.derivatives import check_derivatives

ENGINES = ("numpy", "numba")
Grid = namedtuple("Grid", "n spacing")


@dataclass
class Physics:
    gravity: float
    weights: np.ndarray

    def drag(self, u):
        return u * self.gravity


class Constants:
    scale = 1.5
    table = np.array([0.5, 2.0, 1.0, 3.0])


class Settings(Constants):
    cutoff = 0.3

    def __init__(self, order):
        self.order = order


CONFIG = {"dt": 0.1, "steps": 2, "solver": {"relaxation": 0.7, "method": "sor"}, "time scale": 3.0, "w": np.ones(4)}
PHYSICS = Physics(9.81, np.array([1.0, 2.0, 3.0, 4.0]))
SPACE = SimpleNamespace(damping=0.25, inner=PHYSICS)
GRID = Grid(3, (0.5, 0.25))
SETTINGS = Settings(3)


def step(u, v):
    for _ in range(CONFIG["steps"]):
        for i in range(GRID.n):
            u[i] += CONFIG["dt"] * v[i] * PHYSICS.weights[i] - CONFIG["solver"]["relaxation"] * u[i] * SPACE.damping
            if CONFIG["solver"]["method"] == "sor" and abs(v[i]) > SETTINGS.cutoff:
                v[i] *= Constants.table[i] * Constants.scale ** SETTINGS.order
    return np.sum(u * CONFIG["w"]) * SPACE.inner.gravity / CONFIG["time scale"] + Settings.scale * SETTINGS.scale * v[0]


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_constants_that_are_held(engine):
    u, v = np.array([0.3, 0.6, 0.9, 1.2]), np.array([0.2, 0.7, 0.4, 0.5])
    check_derivatives(step, (u, v), ("u", "v"), ("u", "v", "return"), engine)


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


def unknown_item(x):
    return np.sum(x) * CONFIG["stepz"]


def unknown_field(x):
    return np.sum(x) * PHYSICS.gravitas


def handed_on(x):
    return np.sum(x) * len(CONFIG)


def written(x):
    CONFIG["dt"] = 0.3
    x[0] *= CONFIG["dt"]


@pytest.mark.parametrize("kernel, message", [
    (unknown_item, "error[S202]: 'CONFIG' has no 'stepz'\n    return np.sum(x) * CONFIG[\"stepz\"]\n"
                   "                       ^^^^^^^^^^^^^^^\n  help: did you mean 'CONFIG['steps']'?"),
    (unknown_field, "error[S202]: 'PHYSICS' has no 'gravitas'\n    return np.sum(x) * PHYSICS.gravitas\n"
                    "                       ^^^^^^^^^^^^^^^^\n  help: did you mean 'PHYSICS.gravity'?"),
    (handed_on, "error[S201]: 'CONFIG' cannot be used in a kernel: it is a dict\n"
                "    return np.sum(x) * len(CONFIG)\n                           ^^^^^^\n"
                "  help: name the number or array that is in it, or pass it as an argument"),
    (written, "error[S201]: 'CONFIG' cannot be used in a kernel: it is a dict\n"
              "    CONFIG[\"dt\"] = 0.3\n    ^^^^^^\n"
              "  help: name the number or array that is in it, or pass it as an argument"),
])
def test_what_is_refused(kernel, message):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.differentiate(kernel).adjoint_source(np.ones(3))
    lines = [line.split(" | ")[-1] if " | " in line else line.partition("error[")[1] + line.partition("error[")[2]
             or line for line in str(caught.value).splitlines()]
    assert [line.strip() for line in lines] == [line.strip() for line in message.splitlines()]


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


MANY = tuple(float(k) for k in range(100))


def as_python_has_them(x):
    row = STAGES[1]
    return x[0] * row[0] + np.sum(x) * len(WEIGHTS * 2) + np.sum(x * PAIRS[0][0]) * MANY[x.size]


def repeated(x):
    return np.sum(x) * len(MANY * 2)


def test_sequences_are_no_arrays():
    for engine in ENGINES:
        gradient = s2sad.gradient(s2sad.differentiate(as_python_has_them, engine=engine))(np.ones(3))
        np.testing.assert_allclose(gradient, np.array([0.5, 0.0, 0.0]) + 6.0 + 0.5 * 3.0)
    with pytest.raises(s2sad.S2sadError, match="'MANY' cannot be used in a kernel: it is a tuple") as caught:
        s2sad.differentiate(repeated).adjoint_source(np.ones(3))
    assert "help: pick its numbers one by one, or make it a NumPy array" in str(caught.value)


class Doubled(dict):
    def __getitem__(self, key):
        return 2.0 * dict.__getitem__(self, key)


DOUBLED = Doubled(dt=0.1)
COUNTS, GRADES = [0, 0], [[0, 0], [0, 0]]


def items_of_its_own(x):
    return np.sum(x) * DOUBLED["dt"]


def stored_in_a_list(x):
    for k in range(2):
        COUNTS[k] = x[k]
    return COUNTS[0] * x[1]


def stored_in_a_row(x):
    for i in range(2):
        for j in range(2):
            GRADES[i][j] += x[i] * x[j]
    return GRADES[0][1] * x[0]


class Hidden:
    def __init__(self):
        self.__dict__["scale"] = 100.0

    @property
    def scale(self):
        return 3.0


class Metres(float):
    def __mul__(self, other):
        return Metres(2.0 * float(self) * other)

    __rmul__ = __mul__


HIDDEN, LENGTH, TABLE, MASKED, HALF = (
    Hidden(), Metres(1.5), np.matrix([[1.0, 2.0], [3.0, 4.0]]), np.ma.masked_array([1.0, 2.0, 3.0]), np.float16(0.5))


def property_before_a_field(x):
    return x[0] * HIDDEN.scale


def float_of_its_own(x):
    return x[0] * LENGTH


def matrix(x):
    return np.sum(TABLE * TABLE * x[0])


def masked(x):
    return np.sum(MASKED * x)


def half(x):
    return x[0] * HALF


@pytest.mark.parametrize("kernel, message", [
    (property_before_a_field, "'HIDDEN.scale' cannot be used in a kernel: it is a property"),
    (float_of_its_own, "'LENGTH' cannot be used in a kernel: it is a Metres"),
    (matrix, "'TABLE' cannot be used in a kernel: it is a matrix"),
    (masked, "'MASKED' cannot be used in a kernel: it is a MaskedArray"),
    (half, "'HALF' cannot be used in a kernel: it is a float16"),
    (items_of_its_own, "'DOUBLED' cannot be used in a kernel: it is a Doubled"),
    (stored_in_a_list, "'COUNTS' cannot be used in a kernel: it is a list or tuple of the module, and written"),
    (stored_in_a_row, "'GRADES' cannot be used in a kernel: it is a list or tuple of the module, and written"),
])
def test_what_is_not_taken_for_its_numbers(kernel, message):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.differentiate(kernel).adjoint_source(np.ones(3))
    assert f"error[S201]: {message}\n" in str(caught.value)


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
