"""Objects that a kernel is given, or whose method it is: a gradient leaves them as they were."""
from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
import pytest

from s2sad import (
    Const, Duplicated, Reverse, ReverseWithPrimal, S2sadError, autodiff, differentiate, gradient, jvp,
    value_and_gradient, vjp,
)
from tests.evaluate.objects.solvers import Grid, Solver, given_object, subclass
from tests.harness.engines import running, one_line

X = np.array([0.3, 0.7, 1.1, 1.9])


class Model:
    """Counts its calls, keeps its time and a history, and writes a work array."""

    def __init__(self, n):
        self.work, self.calls, self.t, self.history = np.zeros(n), 0, 0.0, []

    def loss(self, x):
        self.calls += 1
        self.t += 0.5
        self.work[:] = x * self.t
        self.history.append(self.t)
        return np.sum(self.work ** 2) * self.calls


class State:
    def __init__(self, u, t=0.0):
        self.u, self.t = u, t


def rebinds(state, x):
    state.u = state.u * x
    state.t = state.t + x[0]
    return np.sum(state.u) * state.t


def writes_and_rebinds(state, x):
    state.u[0] = x[1]
    state.u = state.u * 2.0
    return np.sum(state.u)


def grown(us, vs, x):
    us.append(x)
    return np.sum(vs[-1] * x)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_a_method_that_assigns(engine):
    model = Model(4)
    with running(engine) as run_under:
        found = gradient(differentiate(model.loss, engine=run_under))
        np.testing.assert_allclose(found(X), 2.0 * X * 0.25, rtol=1e-14)
        assert (model.calls, model.t, model.history) == (0, 0.0, []) and not model.work.any()
        model.loss(X)
        np.testing.assert_allclose(found(X), 2.0 * X * 2.0, rtol=1e-14)
        assert (model.calls, model.t, model.history) == (1, 0.5, [0.5])


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_an_object_that_is_given(engine):
    x = 1.0 + 0.3 * np.random.default_rng(5).random(16)
    direction = np.random.default_rng(6).standard_normal(16)

    def along(h):
        return given_object(Solver(Grid(16)), x + h * direction)
    solver = Solver(Grid(16))
    with running(engine) as run_under:
        found = gradient(differentiate(given_object, engine=run_under), wrt="x")(solver, x)
    assert (solver.t, solver.steps) == (0.0, 0)
    np.testing.assert_allclose(found @ direction, (along(1e-5) - along(-1e-5)) / 2e-5, rtol=1e-7)


def test_a_subclass_with_kinks_near():
    """Tangent and adjoint agree, and the value is the kernel's; the limiter's kinks leave differences no room."""
    x = 1.0 + 0.3 * np.random.default_rng(5).random(16)
    direction, f = np.random.default_rng(6).standard_normal(16), differentiate(subclass, engine="numpy")
    value, slope = value_and_gradient(f)(x)
    np.testing.assert_allclose(value, subclass(x), rtol=1e-13)
    np.testing.assert_allclose(slope @ direction, jvp(f, (x,), {"x": direction})["return"], rtol=1e-10)


def test_attributes_that_are_replaced():
    state, f = State(X.copy()), differentiate(rebinds)
    np.testing.assert_allclose(gradient(f, wrt="x")(state, X), X * 0.3 + np.array([np.sum(X * X), 0, 0, 0]), rtol=1e-14)
    np.testing.assert_array_equal(state.u, X)
    with pytest.raises(S2sadError) as caught:
        vjp(f, (state, X), {"state.u": np.ones(4)})
    assert one_line(caught.value).startswith("'state.u' is no output of 'rebinds', which does not write it")
    assert f(state, X) == np.sum(X * X) * 0.3 and state.t == 0.3


class Kind(Enum):
    DOUBLE = 2


@dataclass
class Parts:
    """Functions, classes and members of enumerations as attributes of an object that is given."""
    f: Any
    kind: Kind | None
    made: Any
    w: float


def halved(v):
    return 0.5 * v


def of_parts(parts, x):
    scale = 2.0 if parts.kind is Kind.DOUBLE else 1.0
    return np.sum(parts.f(x)) * scale + parts.made(x[0], Kind.DOUBLE, None, parts.w).f * parts.w


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_functions_that_objects_hold(engine):
    with running(engine) as run_under:
        found = gradient(differentiate(of_parts, engine=run_under), wrt="x")
        first = np.array([3.0, 0, 0, 0])
        np.testing.assert_allclose(found(Parts(np.sin, Kind.DOUBLE, Parts, 3.0), X), 2.0 * np.cos(X) + first)
        np.testing.assert_allclose(found(Parts(halved, Kind.DOUBLE, Parts, 3.0), X), np.ones(4) + first)
        np.testing.assert_allclose(found(Parts(halved, None, Parts, 3.0), X), 0.5 * np.ones(4) + first)
        with pytest.raises(S2sadError) as caught:
            found(Parts(object(), Kind.DOUBLE, Parts, 3.0), X)
    assert one_line(caught.value).startswith("'parts.f' is an object")


def test_what_is_written_and_replaced():
    with pytest.raises(S2sadError) as caught:
        gradient(differentiate(writes_and_rebinds), wrt="x")(State(X.copy()), X)
    assert one_line(caught.value) == ("'state.u' is written in place, and replaced by another array in the object that "
                                      "has it: do either of them")


def test_an_object_that_is_given_twice():
    us = [X.copy()]
    with pytest.raises(S2sadError) as caught:
        gradient(differentiate(grown), wrt="x")(us, us, X)
    assert one_line(caught.value) == "'us' and 'vs' are one object, which is changed: pass a copy"
    np.testing.assert_array_equal(gradient(differentiate(grown), wrt="x")([X], [X.copy()], X), X)


class Part:
    def __init__(self, t):
        self.t, self.h = t, [2.0 * t]

    def swapped(self):
        self.t, self.h[0] = self.h[0], self.t


def swapped_back(first, second, x):
    first.swapped()
    between = second.t * second.h[0] ** 2
    first.swapped()
    return between * x


def grown_and_shrunk(us, vs, x):
    us.append(x)
    between = len(vs)
    us.pop()
    return between * np.sum(x)


def swapped_in_a_helper(first, second, x):
    return swapped_back(first, second, x) * x


def test_an_object_that_is_given_twice_and_changed_for_a_while():
    part, us = Part(1.5), [X.copy()]
    calls: list[Any] = [(swapped_back, (part, part, 0.5), "'first' and 'second'"),
                        (swapped_in_a_helper, (part, part, 0.5), "'first' and 'second'"),
                        (grown_and_shrunk, (us, us, X), "'us' and 'vs'")]
    for kernel, given, said in calls:
        with pytest.raises(S2sadError) as caught:
            gradient(differentiate(kernel), wrt="x")(*given)
        assert one_line(caught.value).startswith(f"{said} are one object, which is changed: pass a copy"), kernel
    assert gradient(differentiate(swapped_back), wrt="x")(part, Part(1.5), 0.5) == 1.5 * 9.0


def left_with_what_it_has_made(part, x):    # noqa: RET503
    for _, v in zip((part, part), x):
        part.h.append(np.sin(v))
        for _ in range(3):
            held = []
            for w in x:
                held.append(lambda p, w=w: p * w + 1.5)
            if True:
                return -0.7


def grown_where_a_loop_is_left(part, x):
    count = 0
    while x[0] < 3.0:
        count += 1
        if count > 3:
            break
        x[0] = x[0] * 0.9 + 0.5
        inner = 0
        while part.t < left_with_what_it_has_made(part, x):
            inner += 1
            if inner > 3:
                break
            part.t = part.t * 0.9 + 0.5
            x[1:] += left_with_what_it_has_made(part, x)
    return np.sum(x)


def test_a_list_that_is_made_where_a_loop_is_left():
    found = gradient(differentiate(grown_where_a_loop_is_left), wrt="x")(Part(0.3), np.array([1.1, 0.5, 0.2]))
    np.testing.assert_allclose(found, [0.9 ** 3, 1.0, 1.0])


def multiplied(state, x):
    state.u = state.u * x
    return np.sum(state.u * x)


def test_autodiff_refuses_to_leave_another_array_where_one_was():
    state = State(X.copy())
    for mark in (Duplicated(state, State(np.ones(4))), Const(state)):
        with pytest.raises(S2sadError) as caught:
            autodiff(Reverse, multiplied, mark, Const(X.copy()))
        assert one_line(caught.value) == (
            "'multiplied' leaves something else in 'state' than was there, which autodiff does not do: use s2sad.vjp "
            "or s2sad.gradient, which change no argument, or write arrays in place")
    np.testing.assert_allclose(gradient(differentiate(multiplied), wrt="x")(State(X.copy()), X), 2.0 * X * X)


class Rebinding(Model):
    def loss(self, x):
        self.work = 2.0 * x
        return np.sum(self.work ** 2)


class Writing(Model):
    def loss(self, x):
        self.work[:] = 2.0 * x
        return np.sum(self.work ** 2)


@pytest.mark.parametrize("model", [Model(4), Rebinding(4)], ids=["counted", "rebound"])
def test_autodiff_refuses_to_leave_a_bound_object_half_done(model):
    with pytest.raises(S2sadError) as caught:
        autodiff(Reverse, model.loss, Duplicated(X.copy(), np.zeros(4)))
    assert one_line(caught.value) == (
        "'loss' leaves something else in 'self' than was there, which autodiff does not do: use s2sad.vjp or "
        "s2sad.gradient, which change no argument, or write arrays in place")
    assert model.calls == 0 and not model.work.any()


def test_autodiff_writes_the_arrays_of_a_bound_object():
    model, shadow = Writing(4), np.zeros(4)
    autodiff(ReverseWithPrimal, model.loss, Duplicated(X.copy(), shadow))
    np.testing.assert_allclose(shadow, 8.0 * X)
    np.testing.assert_array_equal(model.work, 2.0 * X)
