"""Matrices and products with Hessians of functions that take structures: a part is meant by its path."""
from __future__ import annotations

import copy
from dataclasses import dataclass
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

import s2sad
from tests.harness.engines import one_line, running


@dataclass
class State:
    u: np.ndarray
    time: float


class Rates(NamedTuple):
    growth: float
    decay: np.ndarray


def moved(out, state, p, layers):
    for i in range(state.u.size):
        out[i] = p.growth * np.sin(state.u[i]) * layers[0]["w"][i] + state.u[i - 1] ** 2 - p.decay[i] * state.time


def energy(state, p, layers):
    total = 0.0
    for i in range(state.u.size):
        total += p.growth * np.sin(state.u[i]) * layers[0]["w"][i] ** 2 + state.u[i - 1] ** 2 * state.u[i] * p.decay[i]
    return total * state.time


def ticks(state, h):
    state.time += h
    return state.time ** 2 * np.sum(state.u ** 2)


def given():
    return (State(np.array([0.3, 0.5, 0.9, 0.2]), 0.7), Rates(2.0, np.array([0.1, 0.4, 0.2, 0.3])),
            [{"w": np.array([1.0, 2.0, 0.5, 0.8]), "name": "first"}])


PARTS = {"state.u": lambda a: a[0].u, "state.time": lambda a: a[0].time, "p.growth": lambda a: a[1].growth,
         "p.decay": lambda a: a[1].decay, "layers[0]['w']": lambda a: a[2][0]["w"]}


def changed(args, path, by):
    """The arguments, with a part changed."""
    state, p, layers = copy.deepcopy(args)
    held = {"state.u": lambda: setattr(state, "u", state.u + by), "layers[0]['w']": lambda: layers[0].update(
        w=layers[0]["w"] + by), "state.time": lambda: setattr(state, "time", state.time + by)}
    if path in held:
        held[path]()
        return state, p, layers
    name = path.partition(".")[2]
    return state, p._replace(**{name: getattr(p, name) + by}), layers


def along(of, args, path, direction):
    """How something changes with a part, by extrapolated central differences."""
    def central(h):
        return (of(*changed(args, path, h * direction)) - of(*changed(args, path, -h * direction))) / (2.0 * h)
    return (4.0 * central(5e-4) - central(1e-3)) / 3.0


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("path", PARTS)
def test_jacobians(path, engine):
    args, v = given(), PARTS[path](given())
    direction = np.linspace(-1.0, 1.0, np.size(v)) if np.ndim(v) else 1.0

    def written(*args):
        out = np.zeros(4)
        moved(out, *args)
        return out
    with running(engine) as run_under:
        f = s2sad.differentiate(moved, engine=run_under)
        forward, reverse = (s2sad.jacobian(f, path, "out", mode=mode)(np.zeros(4), *args)
                            for mode in ("forward", "reverse"))
        sparse = s2sad.jacobian(f, path, "out", sparse=True)(np.zeros(4), *args)
    assert forward.shape == (4, *np.shape(v))
    np.testing.assert_allclose(forward @ direction if np.ndim(v) else forward, along(written, args, path, direction),
                               rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(reverse, forward, rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(sparse.toarray(), forward.reshape(4, -1), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("engine", ["numpy", "loops", "numba"])
@pytest.mark.parametrize("path", PARTS)
def test_second_derivatives(path, engine):
    args, v = given(), PARTS[path](given())
    direction = np.linspace(-1.0, 1.0, np.size(v)) if np.ndim(v) else 1.0
    with running(engine) as run_under:
        f = s2sad.differentiate(energy, engine=run_under)
        for wrt in PARTS:
            found = s2sad.hvp(f, args, {path: direction}, wrt=wrt)
            wanted = along(s2sad.gradient(f, wrt), args, path, direction)
            np.testing.assert_allclose(found, wanted, rtol=1e-8, atol=1e-9)
        whole = s2sad.hessian(f, path)(*args)
        np.testing.assert_allclose(whole @ direction if np.ndim(v) else whole * direction, s2sad.hvp(
            f, args, {path: direction}), rtol=1e-13, atol=1e-14)
        np.testing.assert_allclose(s2sad.hessian(f, path, sparse=True)(*args).toarray(), np.reshape(
            whole, 2 * (np.size(v),)), rtol=1e-13, atol=1e-14)


def test_whole_structures():
    args = given()
    found = s2sad.hvp(energy, args, {"state": State(np.ones(4), 0.0)}, wrt=("state", "layers"))
    assert isinstance(found["state"], State) and found["layers"][0]["name"] == "first"
    np.testing.assert_allclose(found["state"].u, s2sad.hvp(energy, args, {"state.u": np.ones(4)}), rtol=1e-14)
    same = s2sad.hvp(energy, args, {"state": State(np.ones(4), 0.5)})
    np.testing.assert_allclose(same.u, found["state"].u + s2sad.hvp(
        energy, args, {"state.time": 0.5}, wrt="state.u"), rtol=1e-13)
    assert np.array_equal(args[0].u, given()[0].u) and args[0].time == 0.7


def test_a_field_that_is_assigned():
    state = SimpleNamespace(u=np.array([0.5, 1.0]), time=0.4)
    np.testing.assert_allclose(s2sad.hvp(ticks, (state, 0.1), {"h": 1.0}), 2.0 * np.sum(state.u ** 2), rtol=1e-14)
    np.testing.assert_allclose(s2sad.hvp(ticks, (state, 0.1), {"state.time": 1.0}), 2.0 * np.sum(state.u ** 2),
                               rtol=1e-14)
    np.testing.assert_allclose(s2sad.hessian(ticks, "state.u")(state, 0.1), 2.0 * 0.5 ** 2 * np.eye(2), atol=1e-15)
    assert state.time == 0.4


@pytest.mark.parametrize(("wanted", "ask"), [
    ("'state.time' is a number that 'ticks' assigns, which has no matrix: write a function that takes it as an "
     "argument, or returns it", lambda: s2sad.hessian(ticks, "state.time")(State(np.ones(2), 0.4), 0.1)),
    ("the seed of 'state.u' is an array of float64 of shape (2,), its output one of float64 of shape (4,): give an "
     "array of float64 of shape (4,)", lambda: s2sad.hvp(energy, given(), {"state.u": np.ones(2)})),
    ("the direction of 'state' is of type ndarray or has other parts: 'state' is a dataclass: make one "
     "with s2sad.make_zero(state)", lambda: s2sad.hvp(energy, given(), {"state": np.ones(4)})),
    ("directions names 'state.v', and 'state' has no such part: its parts are state.u, state.time",
     lambda: s2sad.hvp(energy, given(), {"state.v": np.ones(4)})),
    ("wrt names 'layers[0]['name']', which is a str", lambda: s2sad.hvp(
        energy, given(), {"state.u": np.ones(4)}, wrt="layers[0]['name']")),
    ("wrt names 'state', which holds 2 floats: state.u, state.time: a matrix is with respect to one: wrt=\"state.u\"",
     lambda: s2sad.hessian(energy, "state")(*given()))])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    assert one_line(caught.value) == wanted
