"""Gradients of losses of solutions: three ways, against differences of the loss and each other."""
from __future__ import annotations

import copy
import pickle
import sys

import numpy as np
import pytest

import s2sad
from tests.harness.engines import one_line, running
from tests.odes import kernels

integrate = pytest.importorskip("scipy.integrate")
P, Z, T = np.array([1.5, 1.0, 0.7, 1.2]), np.array([1.3, 0.8]), np.linspace(0.0, 3.0, 5)
PLANE = np.linspace(0.5, 1.5, 6).reshape(2, 3)
CASES = [(kernels.hunters, kernels.misfit, Z, (P,)), (kernels.hunters_in_place, kernels.misfit, Z, (P,)),
         (kernels.forced, kernels.misfit, Z, (0.3, np.array([0.5, 1.0]))),
         (kernels.grid, kernels.of_a_plane, PLANE, (0.3,))]
WAYS = [("forward", {}), ("adjoint", {}), ("discrete", {"steps": 20}), ("discrete", {"steps": 20, "snapshots": 4}),
        ("discrete", {"steps": 10, "method": "SDIRK2"}),
        ("discrete", {"steps": 10, "method": "SDIRK4", "snapshots": 3})]
NAMES = ["forward", "adjoint", "discrete", "snapshots", "implicit", "implicit-snapshots"]


def central(of, given, k, direction):
    """The derivative of the loss along a direction of one argument, by extrapolated differences."""
    def at(h):
        changed = [*given]
        changed[k] = changed[k] + h * direction
        return of(*changed)
    return (8.0 * (at(1e-3) - at(-1e-3)) - (at(2e-3) - at(-2e-3))) / (12.0 * 1e-3)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("case", "way", "more"), [
    pytest.param(case, way, more, id=f"{case[0].__name__}-{name}") for (way, more), name in zip(WAYS, NAMES)
    for case in (CASES[2:3] if name == "implicit-snapshots" else CASES)])
def test_against_differences(case, way, more, engine):
    f, loss, u, args = case
    before = copy.deepcopy((u, args))
    with running(engine) as run_under:
        g = s2sad.differentiate(f, engine=run_under)
        value, found = s2sad.ode_gradient(g, loss, way=way, rtol=1e-10, atol=1e-12, **more)(u, T, *args)
        names = list(found)
        assert len(names) == 1 + len(args)
        by_steps = s2sad.ode_gradient(g, loss, names[0], way=way, **more)

        def of(u, *args):
            if way == "discrete":
                return by_steps(u, T, *args)[0]
            solution = integrate.solve_ivp(s2sad.ode(f, shape=u.shape), (T[0], T[-1]), u.reshape(-1), args=args,
                                           method="DOP853", rtol=1e-12, atol=1e-14, t_eval=T)
            return loss(solution.y.T.reshape(-1, *u.shape))
        np.testing.assert_allclose(value, of(u, *args), rtol=1e-8)
        for k, (name, held) in enumerate(zip(names, (u, *args))):
            direction = np.linspace(-1.0, 1.3, np.size(held)).reshape(np.shape(held)) if np.ndim(held) else 1.0
            assert np.shape(found[name]) == np.shape(held)
            wanted = central(of, (u, *args), k, direction)
            np.testing.assert_allclose(np.sum(found[name] * direction), wanted, rtol=1e-6, atol=1e-7)
    np.testing.assert_array_equal(u, before[0])
    for ours, theirs in zip(args, before[1]):
        np.testing.assert_array_equal(ours, theirs)


def test_compiled_and_snapshots_give_the_same():
    wanted = s2sad.ode_gradient(kernels.hunters, kernels.misfit, way="adjoint")(Z, T, P)
    for way, more in WAYS[2:4]:
        found = s2sad.ode_gradient(s2sad.differentiate(kernels.hunters, engine="numba"), kernels.misfit, way=way,
                                   **{**more, "steps": 100})(Z, T, P)
        np.testing.assert_allclose(found[1]["p"], wanted[1]["p"], rtol=1e-6)
        np.testing.assert_allclose(found[1]["z"], wanted[1]["z"], rtol=1e-6)


@pytest.mark.parametrize("method", ["Radau", "BDF", "LSODA", "DOP853"])
def test_other_integrators(method):
    wanted = s2sad.ode_gradient(kernels.hunters, kernels.misfit, "p", rtol=1e-10)(Z, T, P)
    for way in ("forward", "adjoint"):
        found = s2sad.ode_gradient(kernels.hunters, kernels.misfit, "p", way=way, method=method, rtol=1e-9, atol=1e-11)(
            Z, T, P)
        np.testing.assert_allclose(found[1], wanted[1], rtol=1e-4)


def test_what_is_asked_for():
    ask = s2sad.ode_gradient(s2sad.ode(kernels.grid, shape=(2, 3), sparse=True), kernels.of_a_plane, "k", way="adjoint")
    value, found = ask(PLANE, T, 0.3)
    assert isinstance(found, float)
    for u in (np.asfortranarray(PLANE), np.repeat(PLANE, 2, axis=1)[:, ::2], PLANE.tolist()):
        assert ask(u, T, 0.3) == (value, found)
    frozen = PLANE.copy()
    frozen.flags.writeable = False
    assert ask(frozen, [*T], 0.3) == (value, found)
    again = pickle.loads(pickle.dumps(ask))
    assert again(PLANE, T, 0.3) == (value, found) and repr(again) == "<loss and gradient of grid, adjoint>"
    whole = s2sad.ode_gradient(kernels.forced, kernels.misfit, ("rate", "u", "rate"))(np.array([1, 2]), T, 1, P[:2])
    assert list(whole[1]) == ["rate", "u"] and whole[1]["u"].shape == (2,)


def rate_of_a_model(du, u, model, t):
    for i in range(u.size):
        du[i] = -model["k"] * u[i]


@pytest.mark.parametrize("way", ["forward", "adjoint"])
def test_what_is_no_float_is_handed_on(way):
    value, found = s2sad.ode_gradient(rate_of_a_model, kernels.misfit, way=way)(Z, T, {"k": 0.5})
    us = Z * np.exp(-0.5 * T)[:, None]
    wanted = np.sum(np.stack([2.0 * us[:, 0], np.cos(us[:, 1])], axis=1) * np.exp(-0.5 * T)[:, None], axis=0)
    np.testing.assert_allclose(value, kernels.misfit(us), rtol=1e-7)
    np.testing.assert_allclose(found, wanted, rtol=1e-6)


@pytest.mark.parametrize(("method", "order"), [("RK4", 4), ("midpoint", 2), ("SDIRK2", 2), ("SDIRK4", 4)])
@pytest.mark.parametrize("f", [kernels.hunters, kernels.forced])
def test_orders(f, method, order):
    """Half the step has the error of gradients that the order says, also where the rate depends on the time."""
    args = (P,) if f is kernels.hunters else (0.3, np.array([0.5, 1.0]))
    exact = s2sad.ode_gradient(f, kernels.misfit, way="adjoint", method="DOP853", rtol=1e-12, atol=1e-13)(Z, T, *args)
    name = list(exact[1])[1]
    g = s2sad.differentiate(f, engine="numpy")
    errors = [np.max(np.abs(s2sad.ode_gradient(g, kernels.misfit, way="discrete", method=method, steps=steps)(
        Z, T, *args)[1][name] - exact[1][name])) for steps in (8, 16)]
    assert order - 0.5 < np.log2(errors[0] / errors[1]) < order + 0.5


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_stiff_equations(engine):
    """Explicit steps would have to be a thousand times as short."""
    wanted = s2sad.ode_gradient(kernels.relaxes, kernels.misfit, way="adjoint", method="Radau", rtol=1e-8)(Z, T, 1e4)
    with running(engine) as run_under:
        value, found = s2sad.ode_gradient(s2sad.differentiate(kernels.relaxes, engine=run_under), kernels.misfit,
                                          way="discrete", method="SDIRK4", steps=20)(Z, T, 1e4)
    np.testing.assert_allclose(value, wanted[0], rtol=1e-5)
    np.testing.assert_allclose(found["u"], wanted[1]["u"], rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(found["k"], wanted[1]["k"], rtol=0.03)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_newton_that_does_not_converge_has_no_gradient(engine):
    with running(engine) as run_under:
        ask = s2sad.ode_gradient(s2sad.differentiate(kernels.explodes, engine=run_under), kernels.misfit,
                                 way="discrete", method="SDIRK2", steps=1)
        before = Z.copy()
        with pytest.raises(s2sad.S2sadError, match="S502") as caught:
            ask(Z, T, 2.0)
    assert one_line(caught.value) == ("Newton's method did not converge for a stage of 'explodes': take more steps, or "
                                      "see whether the rate is finite; there is no gradient")
    np.testing.assert_array_equal(Z, before)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("way", ["forward", "adjoint"])
def test_a_failing_integrator_has_no_gradient(way):
    ask = s2sad.ode_gradient(kernels.explodes, kernels.misfit, way=way)
    with pytest.raises(s2sad.S2sadError, match="S502") as caught:
        ask(Z, T, 2.0)
    assert one_line(caught.value).endswith("Required step size is less than spacing between numbers.: take another "
                                           "method, or other tolerances; there is no gradient")
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.ode_gradient(kernels.roots, kernels.misfit, way=way)(-Z, T, 2.0)
    assert one_line(caught.value) == ("the integration of 'roots' failed after t = 0: the rate is not finite: take "
                                      "another method, or other tolerances; there is no gradient")


def test_it_needs_scipy(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.integrate", None)
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.ode_gradient(kernels.hunters, kernels.misfit)(Z, T, P)
    assert one_line(caught.value) == ('way="forward" needs SciPy, which is not installed: pip install "s2sad[jit]", or '
                                      'take way="discrete"')
    s2sad.ode_gradient(kernels.hunters, kernels.misfit, way="discrete", steps=2)(Z, T, P)


def made(**how):
    return s2sad.ode_gradient(kernels.hunters, kernels.misfit, **how)


@pytest.mark.parametrize(("wanted", "ask"), [
    ("there is no way 'reverse': \"forward\", \"adjoint\" or \"discrete\"", lambda: made(way="reverse")),
    ("the discrete way takes fixed steps, and there are None: give how many there are between one time and the next: "
     "steps=100", lambda: made(way="discrete")),
    ("the discrete way has no method 'Radau': it has RK4, midpoint, SDIRK2, SDIRK4",
     lambda: made(way="discrete", steps=2, method="Radau")),
    ("wrt names 'q', neither the state of 'hunters' nor among its arguments: these are z, p", lambda: made(wrt="q")),
    ("wrt names 't', neither the state of 'hunters' nor among its arguments: these are z, p", lambda: made(wrt="t")),
    ("wrt names 'p' of 'hunters', which is neither a float nor an array of floats: give one, or leave it out of wrt",
     lambda: made(wrt="p")(Z, T, np.arange(4))),
    ("the times are no increasing array of two floats or more: give the first one, at which u is the state, and those "
     "that the loss reads: np.linspace(0.0, 1.0, 11)", lambda: made()(Z, T[::-1], P)),
    ("the state is an array of float64 of shape (): give an array of floats, at least one", lambda: made()(1.0, T, P)),
    ("the state is an array of float64 of shape (0,): give an array of floats, at least one",
     lambda: made()(Z[:0], T, P)),
    ("the state is an array of float64 of shape (2,), which are not finite: give an array of floats, at least one",
     lambda: made()(Z * np.nan, T, P))])
def test_refusals(wanted, ask):
    with pytest.raises(s2sad.S2sadError) as caught:
        ask()
    assert one_line(caught.value) == wanted
