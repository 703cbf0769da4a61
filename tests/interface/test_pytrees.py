"""Gradients, seeds, tangents and shadows have the structure of the arguments and results that they belong to."""
from __future__ import annotations

import copy
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad import (
    Active, Const, Duplicated, Forward, ForwardWithPrimal, Reverse, autodiff, differentiate, explain, gradient, jvp,
    make_zero, value_and_gradient, vjp,
)
from tests.evaluate.structures import arguments as structures
from tests.evaluate.structures.arguments import U, X, Layer, Loss, Orbit, Params, Spring, State, array, params, state_of
from tests.evaluate.structures.kernels import doubled, loss, orbit, step, with_none
from tests.harness.refusals import refused

ENGINES = ["numpy", "numba"]


def same(a: Any, b: Any) -> bool:
    if isinstance(a, (State, Loss, SimpleNamespace)):
        return type(a) is type(b) and same(vars(a), vars(b))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, (tuple, list)):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, np.ndarray):
        return np.allclose(a, b, rtol=1e-12)
    return type(a) is type(b) and (a == b or isinstance(a, float) and abs(a - b) < 1e-12 * abs(a))


def twin(u, t, k, w, dt):
    s = State(u, np.zeros(3), t)
    step(s, Params(k, w), dt)
    return s


@pytest.fixture(params=ENGINES)
def engine(request):
    return request.param


def test_gradients_have_the_structure_of_the_arguments(engine):
    f, arguments = differentiate(loss, engine=engine), (state_of(), params(), 0.1, {"scale": 0.7})
    before = copy.deepcopy(arguments)
    value, found = value_and_gradient(f)(*arguments)
    assert same(value, float(loss(*copy.deepcopy(arguments))))
    assert list(found) == ["state", "p", "dt", "opts"] and same(arguments, before)
    assert isinstance(found["state"], State) and found["state"].n == 3 and found["state"].log is None
    assert isinstance(found["p"], Params) and isinstance(found["p"].k, float) and isinstance(found["state"].t, float)
    assert same(gradient(f, wrt="state")(*arguments), found["state"])
    assert same(gradient(f, wrt="state.u")(*arguments), found["state"].u)
    assert same(gradient(f, wrt=("p", "opts['scale']"))(*arguments),
                {"p": found["p"], "opts['scale']": found["opts"]["scale"]})
    assert same(gradient(f, wrt='opts["scale"]')(*arguments), found["opts"]["scale"])


def test_seeds_and_tangents_are_structures(engine):
    f, arguments = differentiate(step, engine=engine), (state_of(), params(), 0.1)
    ones = State(np.ones(3), np.ones(3), 1.0)
    found = vjp(f, arguments, {"state": ones}, wrt=("state", "p"))
    # u' = u (1 + dt k w) + dt t, t' = t + dt k, v' = v
    assert same(found["state"], State(1.0 + 0.2 * params().w, np.ones(3), 1.0 + 0.3))
    assert same(found["p"], Params(0.1 * float(params().w @ state_of().u) + 0.1, 0.2 * state_of().u))
    assert same(vjp(f, arguments, {"state.t": 1.0}, wrt="p.k"), {"p.k": 0.1})
    dots = jvp(f, arguments, {"state": ones})
    assert same(dots, {"state": State(1.0 + 0.2 * params().w + 0.1, np.ones(3), 1.0)})
    assert same(jvp(f, arguments, {"p.k": 1.0}, of="state.t"), {"state.t": 0.1})


def test_results_are_structures(engine):
    f, arguments = differentiate(orbit, engine=engine), (Orbit(1.0, 2.0), 0.1, 4)
    seed = Loss(1.0, {"x": 0.5, "v": 0.0})
    found = vjp(f, arguments, {"return": seed}, wrt="start")["start"]
    dots = jvp(f, arguments, {"start": Orbit(0.3, 0.7)})["return"]
    assert isinstance(dots, Loss) and list(dots.parts) == ["x", "v"]
    assert abs(0.3 * found.x + 0.7 * found.v - dots.total - 0.5 * dots.parts["x"]) < 1e-12
    tangent, primal = autodiff(ForwardWithPrimal, f, Duplicated(Orbit(1.0, 2.0), Orbit(0.3, 0.7)), Const(0.1), 4)
    assert same(tangent, dots) and same(primal, orbit(*arguments))


def test_an_argument_that_is_returned():
    f, ones = differentiate(doubled, engine="numpy"), State(np.ones(3), np.ones(3), 1.0)
    wanted = {"state": State(array([3.0, 2.0, 2.0]), np.ones(3), 2.0)}
    assert same(vjp(f, (state_of(),), {"return": ones}), wanted)
    assert same(vjp(f, (state_of(),), {"state": ones}), wanted)
    found = jvp(f, (state_of(),), {"state": ones}, of="return")["return"]
    assert same((found.u, found.v, found.t, found.n), (2.0 * np.ones(3), np.ones(3), 3.0, None))


def test_calls_whose_arguments_are_tested_for_none():
    f, u_bar, w_bar = differentiate(with_none, engine="numpy"), np.zeros(2), np.zeros(2)
    wanted = gradient(f)(X, X + 1.0, 2.0)
    assert f.adjoint(X, u_bar, X + 1.0, w_bar, 2.0, 1.0) == (1.0,)
    assert same(wanted, {"u": u_bar, "w": w_bar, "bias": 1.0})
    u_bar[:] = 0.0
    assert f.adjoint(X, u_bar, None, None, 1.0) is None and same(u_bar, gradient(f)(X))
    refused("error[S405]: 'doubled.compiled' was given a structure\n"
            "  help: the bare function takes arrays and numbers: call adjoint or tangent",
            differentiate(doubled).compiled, "adjoint", state_of(), state_of())


def test_autodiff_with_shadows_that_are_structures(engine):
    f, p = differentiate(step, engine=engine), params()
    wanted = vjp(f, (state_of(), p, 0.1), {"state": State(np.ones(3), np.zeros(3), 1.0)})
    state, bar = state_of(), make_zero(state_of())
    assert same(bar, State(np.zeros(3), np.zeros(3), 0.0))
    bar.u[:], bar.t = 1.0, 1.0
    bars = SimpleNamespace(k=0.5, w=np.zeros(3))
    given = SimpleNamespace(k=p.k, w=p.w)
    assert same(autodiff(Reverse, f, Duplicated(state, bar), Duplicated(given, bars), Active(0.1)), (wanted["dt"],))
    after = state_of()
    step(after, p, 0.1)
    assert same(state, after) and same(bar, wanted["state"])
    assert same(bars, SimpleNamespace(k=wanted["p"].k + 0.5, w=wanted["p"].w))
    dot = State(np.ones(3), np.zeros(3), 0.5)
    autodiff(Forward, f, Duplicated(state_of(), dot), Const(p), Const(0.1))
    assert same(dot, jvp(f, (state_of(), p, 0.1), {"state": State(np.ones(3), np.zeros(3), 0.5)})["state"])


def test_the_generated_function_takes_shadows_of_arrays_and_returns_adjoints_of_numbers(engine):
    f, p = differentiate(step, wrt=("state.u", "p"), of="state.u", engine=engine), params()
    wanted = vjp(f, (state_of(), p, 0.1), {"state.u": np.ones(3)})
    bar, p_bar = make_zero(state_of()), make_zero(p)
    bar.u[:] = 1.0
    assert same(f.adjoint(state_of(), bar, p, p_bar, 0.1), (wanted["p"].k,))
    assert same(bar.u, wanted["state.u"]) and same(p_bar.w, wanted["p"].w)
    state = state_of()
    f.primal(state, p, 0.1)
    after = state_of()
    step(after, p, 0.1)
    assert same(state, after)
    dot = State(np.ones(3), np.zeros(3), 0.0)
    f.tangent(state_of(), dot, p, Params(0.0, np.zeros(3)), 0.1)
    assert same(dot.u, jvp(f, (state_of(), p, 0.1), {"state.u": np.ones(3)})["state.u"])


def test_what_is_not_asked_for_is_not_there():
    f = differentiate(step, wrt="state.u", of="state.u", engine="numpy")
    text = f.adjoint_source(state_of(), params(), 0.1)
    assert "def step_adjoint(state_u, state_u_bar, state_v, state_t, state_n, p_k, p_w, dt):" in text
    assert "p_w_bar" not in text and "state_t_bar" not in text
    assert "d(state_u) / d(state_u), engine numpy" in str(explain(f, state_of(), params(), 0.1))


def test_names_that_are_taken():
    def clash(p, p_k):
        p_k_ = p["k"] * p_k
        return p_k_ * p["k"]
    assert gradient(differentiate(clash, engine="numpy"))({"k": 3.0}, 2.0) == {"p": {"k": 12.0}, "p_k": 9.0}


def test_keywords_and_defaults():
    f = differentiate(with_none, engine="numpy")
    assert same(gradient(f, wrt="bias")(X, bias=2.0), 1.0)
    assert same(gradient(f)(u=X), gradient(f)(X, None, None))


def test_an_int_in_a_field_of_floats_is_a_float():
    def scaled(s):
        s.t += s.u[0]
        return s.t * s.u[1]
    s = State(array([2.0, 3.0]), np.zeros(1), 4)  # pyright: ignore[reportArgumentType]
    assert same(gradient(differentiate(scaled, engine="numpy"))(s), State(array([3.0, 6.0]), np.zeros(1), 3.0))


def test_a_zero_gradient_warns():
    f = differentiate(step, engine="numpy")
    with pytest.warns(s2sad.S2sadWarning, match="no output asked for of 'step' depends on 'state.v'") as caught:
        found = vjp(f, (state_of(), params(), 0.1), {"state.u": np.ones(3)}, wrt="state.v")
    assert same(found, {"state.v": np.zeros(3)}) and caught[0].filename == __file__


def test_structures_that_share():
    def both(a, b):
        a.t += b.t
        return a.t * b.u[0]
    f, one, other = differentiate(both, engine="numpy"), state_of(), state_of()
    assert same(gradient(f, wrt=("a.t", "b.t"))(one, other), {"a.t": 1.0, "b.t": 1.0})
    refused("error[S404]: 'a.t' and 'b.t' are one field of one object, and it is assigned\n"
            "  help: pass a copy of one of them", gradient(f), one, one)

    def written(a, b):
        a.u[0] = b.u[1]
        return a.u[0]
    g = differentiate(written, engine="numpy")
    refused("error[S404]: the arguments 'a.u' and 'b.u' share memory, and 'a.u' is written\n"
            "  help: pass a copy of one of them", gradient(g), one, State(one.u, one.v, 1.0))


def test_methods_and_what_they_read_are_watched(monkeypatch):
    def energy(s):
        return s.energy()
    f, spring = gradient(differentiate(energy, engine="numpy"), wrt="s.k"), Spring(array([1.0, 2.0]), 0.5)
    assert f(spring) == 10.0
    monkeypatch.setattr(structures, "GRAVITY", 4.0)
    assert f(spring) == 20.0

    def halved(self, c=1.0):
        return 0.5 * self.k
    monkeypatch.setattr(Spring, "energy", halved)
    assert f(spring) == 0.5
    found = gradient(differentiate(applied, engine="numpy"), wrt="layer")(Layer(U, 3.0), array([1.0, 3.0]))
    assert type(found) is Layer and same(found.w, array([1.0, 3.0])) and found.b == 1.0


def applied(layer, x):
    return layer.apply(x)


def test_make_zero_of_structures():
    @dataclass(frozen=True)
    class Frozen:
        a: tuple
        name: str = "x"
        items: list = field(default_factory=list)
    found = make_zero(Frozen((np.ones(2), 3.0, None, 2), items=[Orbit(1.0, 2.0), object]))
    assert isinstance(found, Frozen) and same(found.a, (np.zeros(2), 0.0, None, 2)) and found.name == "x"
    assert found.items == [Orbit(0.0, 0.0), object]
