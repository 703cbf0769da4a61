"""What directions, matrices, losses and integrators cannot be given: each its own error, with what was given as it was,
under each engine."""
from __future__ import annotations

import copy

import numpy as np
import pytest

import s2sad
from s2sad import BatchDuplicated, Const, Forward, Reverse
from tests.harness.engines import one_line, running

pytest.importorskip("scipy")
ENGINES = pytest.mark.parametrize("engine", ["numpy", "loops"])
U = np.array([0.3, 0.7, 0.2, 0.9])


def rate(du, u, k):
    for i in range(1, u.size):
        du[i] = k * u[i] * u[i - 1]


def decay(du, u, k):
    du[:] = -k * u


def explodes(t, u, k):
    return k * u ** 2


def cubes(u, n):
    return np.sum(u ** 3) * n


def doubled(u):
    return 2.0 * u


def last(us):
    return us[-1]


def total(us):
    return np.sum(us)


def jvp(along, f=rate, args=None):
    return lambda under: s2sad.jvp(under(f), args or (np.zeros(4), U, 2.0), along, batch=True)


def vjp(seeds):
    return lambda under: s2sad.vjp(under(rate), (np.zeros(4), U, 2.0), seeds, batch=True)


def autodiff(mode, *marks):
    return lambda under: s2sad.autodiff(mode, under(rate), *marks)


def jacobian(**how):
    return lambda under: s2sad.jacobian(under(rate), "u", "du", **how)(np.zeros(4), U, 2.0)


def by_the_plan_of_five(under):
    plan = s2sad.jacobian(under(rate), "u", "du", sparse=True).plan(np.zeros(5), np.ones(5), 2.0)
    return s2sad.jacobian(under(rate), "u", "du", sparse=plan)(np.zeros(4), U, 2.0)


def solution(f, loss, **how):
    return lambda under: s2sad.ode_gradient(under(f), loss, **how)(U, np.array([0.0, 10.0]), 2.0)


ONE = np.zeros(4)
REFUSED = {
    "unequal widths": (
        jvp({"u": np.ones((2, 4)), "k": np.ones(3)}),
        "'u' has 2 directions, 'k' has 3: give all of them as many"),
    "unequal widths of shadows": (
        autodiff(Forward, BatchDuplicated(np.zeros(4), (np.zeros(4), np.zeros(4))),
                 BatchDuplicated(U.copy(), (np.ones(4),)), Const(2.0)),
        "'du' has 2 shadows, 'u' has 1: give all of them as many"),
    "no shadow": (
        autodiff(Forward, BatchDuplicated(np.zeros(4), ()), BatchDuplicated(U.copy(), ()), Const(2.0)),
        "the argument 'du' has no shadow: give a tuple with one for each direction: (d1, d2)"),
    "shadows that share memory": (
        autodiff(Reverse, BatchDuplicated(np.zeros(4), (ONE, ONE)),
                 BatchDuplicated(U.copy(), (np.zeros(4), np.zeros(4))), Const(2.0)),
        "the shadow 'du_bar[0]' and the shadow 'du_bar[1]' share memory: give each shadow memory of its own: "
        "s2sad.make_zero(x)"),
    "a tangent of a wrong shape": (
        jvp({"u": np.ones((2, 3))}),
        "the directions of 'u' are an array of float64 of shape (2, 3): give an array of float64 of shape (k, 4),"
        " k directions"),
    "a seed of a wrong shape": (
        vjp({"du": np.ones((2, 5))}),
        "the directions of 'du' are an array of float64 of shape (2, 5): give an array of float64 of shape (k, "
        "4), k directions"),
    "an integer in wrt": (
        jvp({"n": np.ones(2)}, cubes, (U, 3)),
        "wrt names 'n', which is an integer: give a float (3.0, not 3) if it is a real quantity"),
    "an integer in wrt of a Jacobian": (
        lambda under: s2sad.jacobian(under(cubes), "n")(U, 3),
        "wrt names 'n', which is an integer: give a float (3.0, not 3) if it is a real quantity"),
    "a pattern that is too small": (
        jacobian(sparse=np.eye(4)),
        "the pattern of the Jacobian of 'rate' lacks entries: for one more direction the matrix gives something "
        "else than the derivative: give a pattern with all entries that can be other than zero, or sparse=True, "
        "which finds it"),
    "a pattern of another shape": (
        jacobian(sparse=np.eye(3)),
        "the pattern is of shape (3, 3), the matrix of shape (4, 4): give one of that shape"),
    "a plan for other shapes": (
        by_the_plan_of_five,
        "the plan is for a matrix from (5,) to (5,), here it is from (4,) to (4,): make one for these arguments: "
        "J.plan(*args)"),
    "a product of what is no number": (
        lambda under: s2sad.hvp(under(doubled), (U,), {"u": U}),
        "second derivatives are of a function that returns one float; 'doubled' returns float64[:]: write one "
        "that returns the float that is meant"),
    "a loss that is no number": (
        lambda under: s2sad.gradient(under(doubled))(U),
        "a gradient needs a function that returns one float; 'doubled' returns float64[:]: use s2sad.vjp, which "
        "takes a seed for each output"),
    "a loss of a solution that is no number": (
        solution(decay, last),
        "a gradient needs a function that returns one float; 'last' returns float64[:]: use s2sad.vjp, which "
        "takes a seed for each output"),
    "an integrator that fails": (
        solution(explodes, total),
        "the integration of 'explodes' failed after t = 0: Required step size is less than spacing between "
        "numbers.: take another method, or other tolerances; there is no gradient"),
    "an integrator that fails on its way back": (
        solution(explodes, total, way="adjoint"),
        "the integration of 'explodes' failed after t = 0: Required step size is less than spacing between "
        "numbers.: take another method, or other tolerances; there is no gradient"),
    "steps that do not converge": (
        solution(explodes, total, way="discrete", steps=1, method="SDIRK2"),
        "Newton's method did not converge for a stage of 'explodes': take more steps, or see whether the rate is "
        "finite; there is no gradient"),
}


@ENGINES
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("name", REFUSED)
def test_refused(name, engine):
    ask, said = REFUSED[name]
    before = copy.deepcopy(U)
    with running(engine) as under, pytest.raises(s2sad.S2sadError) as caught:
        ask(lambda f: s2sad.differentiate(f, engine=under))
    assert one_line(caught.value) == said
    np.testing.assert_array_equal(U, before)


@ENGINES
def test_no_directions(engine):
    """A width of 0 gives nothing, of the shape that it has."""
    with running(engine) as under:
        f = s2sad.differentiate(rate, engine=under)
        found = s2sad.jvp(f, (np.zeros(4), U, 2.0), {"u": np.ones((0, 4))}, of="du", batch=True)["du"]
        back = s2sad.vjp(f, (np.zeros(4), U, 2.0), {"du": np.ones((0, 4))}, wrt=("u", "k"), batch=True)
    assert found.shape == back["u"].shape == (0, 4) and back["k"].shape == (0,)
