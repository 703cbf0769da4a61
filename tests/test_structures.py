"""Structures: dataclasses, named tuples, dicts, tuples and lists as arguments, inside kernels and as results."""
from __future__ import annotations

import copy
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

import s2sad
from s2sad import (
    Active, Const, Duplicated, Forward, ForwardWithPrimal, Reverse, S2sadError, autodiff, check,
    differentiate, explain, gradient, jvp, make_zero, value_and_gradient, vjp,
)
from tests import structure_kernels
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running

array = np.array
ENGINES = ["numpy", "numba"]


@dataclass
class State:
    u: np.ndarray
    v: np.ndarray
    t: float
    n: int = 3
    log: Any = None


class Params(NamedTuple):
    k: float
    w: np.ndarray


class Orbit(NamedTuple):
    x: float
    v: float


@dataclass(frozen=True)
class Grid:
    n: int
    dx: float


@dataclass
class Model:
    grid: Grid
    fields: tuple
    opts: dict


GRAVITY = 2.0


@dataclass
class Spring:
    x: np.ndarray
    k: float
    t: float = 0.0

    @property
    def size(self):
        return self.x.size

    @staticmethod
    def square(v):
        return v * v

    def energy(self, c=1.0):
        e = 0.0
        for i in range(self.size):
            e += c * self.k * self.x[i] ** 2 * GRAVITY
        return e

    def advance(self, dt):
        for i in range(self.size):
            self.x[i] -= dt * self.k * self.x[i]
        self.t += dt


class Layer:
    def __init__(self, w, b):
        self.w, self.b = w, b

    def apply(self, x):
        return np.sum(self.w * x) + self.b


@dataclass
class Loss:
    total: float
    parts: dict


# -- kernels --------------------------------------------------------------------------------------------------------

def rhs(du, state, p):
    for i in range(state.u.size):
        du[i] = p.k * state.u[i] * p.w[i] + state.t


def step(state, p, dt):
    du = np.zeros_like(state.u)
    rhs(du, state, p)
    for i in range(state.u.size):
        state.u[i] += dt * du[i]
    state.t += dt * p.k


def loss(state, p, dt, opts, mask=None):
    for _ in range(3):
        step(state, p, dt)
    total = 0.0
    for i in range(state.u.size):
        total += state.u[i] ** 2 * opts["scale"]
    if mask is not None:
        total *= mask[0]
    return total + state.t


def nested(m, k, count=None):
    u, v = m.fields
    g = m.grid
    total = 0.0
    for i in range(g.n):
        u[i] += k * v[i] / g.dx
        total += u[i] * m.opts["c"][0] + m.opts["d"]
    for w in (u, v):
        total += w[0]
    for key, value in m.opts.items():
        total += 2.0 if key == "d" else value[0]
    total *= 2.0 if "e" in m.opts else m.opts.get("f", 3.0)
    return total if count is None or count > 2.0 else total * count


def layered(layers, x):
    h = x
    for i, (w, b) in enumerate(layers):
        h = np.tanh(w @ h + b) if i < len(layers) - 1 else w @ h + b
    for k in range(len(layers)):
        h = h * np.sum(layers[k][1])
    for layer, s in zip(reversed(layers[:2]), (1.0, 2.0)):
        h = h + s * layer[0][0, 0]
    w, _ = layers[-1]
    return np.sum(h) * w[0, 0]


def summed(u, mask=None, scale=1.0, bias=None):
    if mask is None:
        mask = np.ones(u.size)
    s = 0.0
    for i in range(u.size):
        s += mask[i] * u[i] * scale
    if bias is not None and bias > 0.0:
        s += bias
    return s


def with_none(u, w=None, bias=None):
    return summed(u) * summed(u, scale=2.0, mask=w) + summed(u, w, bias=bias)


def cells(p, u):
    for i in range(u.size):
        p["acc"] += u[i] * p["k"]
        p["list"][1] = p["acc"] * p["list"][0]
        p["count"] += 1
    return p["acc"]


def doubled(state):
    state.u[:] = state.u * 2.0
    state.t *= state.u[0]
    return state


def handed_back(state, p):
    s = doubled(state)
    q = s
    q.u[0] += p.k
    for a in (state.u, p.w):
        a[1] *= 3.0
    return np.sum(s.u) + np.sum(p.w) * s.t


def moved(o, dt):
    return Orbit(o.x + dt * o.v, v=o.v - dt * o.x ** 2)


def orbit(start, dt, steps):
    o = start
    energy = 0.0
    for _ in range(steps):
        before = o
        o = moved(o, dt)
        if o.x > 1.3:
            o = o._replace(v=o.v * 0.5)
        energy += o.v * before.x
    return Loss(energy * start.x, {"x": o.x, "v": o.v})


def pair_step(o, dt):
    x, v = o
    return x + dt * v, v - dt * x


def pairs(o, dt):
    x, v = o
    q = (x, v)
    for _ in range(3):
        x, v = pair_step((x, v), dt)
        q = pair_step(q, dt)
    return x * v + q[0] + o.x


def shaped(shape, index, c):
    a = np.zeros(shape)
    a[index] = c
    a[0, 0] += c * c
    return np.sum(a)


def released(spring, layer, dt):
    for _ in range(3):
        spring.advance(dt)
    return spring.energy(c=2.0) + spring.square(spring.t) * layer.apply(spring.x)


def tossed(o, n, flag):
    for _ in range(n):
        o, last = Orbit(o.v * 2.0, o.x), o
    p = Orbit(last.x, 1.0)
    if flag > 0.0:
        p = Orbit(p.v, p.x * o.v)
    return max(p) * sum(p) + p[1]


def swapped(m):
    m["a"].t, m["b"].t = m["b"].t, m["a"].t
    s = m["a"]
    for _ in range(3):
        s.t *= m["b"].t
        m["a"].v[0] += s.t
    for s in (m["a"], m["b"]):
        for k in range(s.u.size):
            if s.u[k] > 1.5:
                break
            s.t += s.u[k]
    return m["a"].v[0] * m["b"].t


def left_behind(state):
    old = (state.t, state.u[0])
    state.t *= 3.0
    while state.t < 10.0:
        state.t *= 1.7
        if state.t > 5.0:
            state.u[0] = state.t
            break
    return old[0] * state.t + old[1] * state.u[0]


def advanced(s, x):
    s.t += x
    return Orbit(s.t, x)


def maybe(s, p=None):
    if p is None:
        return s.t
    return s.t * p.k


def handed_out(s, p):
    a = advanced(s, 1.0)
    b = advanced(s, a.x)
    own = {"k": p.k, "t": s.t, "u": s.u}
    own["k"] += 1.0
    own["t"] *= own["k"]
    own["u"][0] *= own["t"]
    s.v += s.t
    s.v *= s.v
    return a.x * b.v + b.x + maybe(s) * maybe(s, p) + own["t"] * p.k + np.sum(s.v) + s.u[0]


def state_of():
    return State(array([1.0, 2.0, 3.0]), np.zeros(3), 0.5)


def params():
    return Params(2.0, array([0.1, 0.2, 0.3]))


def model():
    return Model(Grid(3, 0.5), (array([1.0, 2.0, 3.0]), array([4.0, 5.0, 6.0])), {"c": array([2.0]), "d": 3.0})


LAYERS = [(array([[0.1, 0.2], [0.3, 0.4]]), array([0.1, 0.2])),
          (array([[0.5, 0.6], [0.7, 0.1], [0.2, 0.3]]), array([0.3, 0.2, 0.1]))]
X = array([0.5, 0.7])
CASES = [
    (loss, lambda: (state_of(), params(), 0.1, {"scale": 0.7})),
    (loss, lambda: (state_of(), params(), 0.1, {"scale": 0.7}, array([2.0]))),
    (nested, lambda: (model(), 0.3)),
    (nested, lambda: (model(), 0.3, 1.5)),
    (layered, lambda: (LAYERS, X)),
    (with_none, lambda: (X,)),
    (with_none, lambda: (X, None, 2.0)),
    (with_none, lambda: (X, array([2.0, 3.0]))),
    (cells, lambda: ({"acc": 0.5, "k": 2.0, "list": [3.0, 1.0], "count": 0}, X)),
    (handed_back, lambda: (SimpleNamespace(u=array([1.0, 2.0]), t=2.0), SimpleNamespace(k=2.0, w=array([3.0, 4.0])))),
    (orbit, lambda: (Orbit(1.0, 2.0), 0.1, 4)),
    (pairs, lambda: (Orbit(1.0, 2.0), 0.1)),
    (shaped, lambda: ((2, 3), (1, 2), 3.0)),
    (tossed, lambda: (Orbit(1.0, 2.0), 3, 1.0)),
    (tossed, lambda: (Orbit(1.0, 2.0), 2, -1.0)),
    (swapped, lambda: ({"a": state_of(), "b": State(array([1.2]), array([0.1]), 0.7)},)),
    (left_behind, lambda: (state_of(),)),
    (handed_out, lambda: (state_of(), params())),
    (released, lambda: (Spring(array([1.0, 2.0]), 0.5), Layer(array([0.3, 0.4]), 2.0), 0.1)),
]


@pytest.mark.parametrize(("kernel", "arguments"), CASES, ids=[f"{k.__name__}{n}" for n, (k, _) in enumerate(CASES)])
def test_derivatives(kernel, arguments):
    found = check(kernel, *arguments(), engine="numpy")
    assert found, str(found)


@pytest.mark.parametrize("case", [0, 4, 8, 10, 13, 15, 17, 18], ids=lambda n: CASES[n][0].__name__)
def test_derivatives_compiled(case):
    kernel, arguments = CASES[case]
    found = check(kernel, *arguments(), engine="numba")
    assert found, str(found)


@pytest.mark.parametrize(("kernel", "arguments"), structure_kernels.CASES, ids=[
    f"{k.__name__}{n}" for n, (k, _) in enumerate(structure_kernels.CASES)])
def test_kernels_that_mislead(kernel, arguments):
    found = check(kernel, *arguments(), engine="numpy")
    assert found, str(found)


# -- drivers --------------------------------------------------------------------------------------------------------

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
    monkeypatch.setitem(globals(), "GRAVITY", 4.0)
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


# -- refusals -------------------------------------------------------------------------------------------------------

def refused(text: str, call: Any, *arguments: Any) -> None:
    with pytest.raises(S2sadError) as caught:
        call(*arguments)
    assert str(caught.value) == text


def field_that_is_not_there(s):
    return s.uu[0]


def key_that_is_not_there(s):
    return s["kk"]


def item_that_is_not_there(s):
    return s[2]


def picked_by_a_number(s):
    total = 0.0
    for i in range(s.n):
        total += s.layers[i]
    return total


def replaced_array(s):
    s.u = s.u * 2.0


def assigned_to_a_named_tuple(s):
    s.k = 2.0


def attribute_of_an_array(s):
    s.a = 1.0


def none_used(s, w):
    return s["k"] * w


def none_or_not(s):
    best = None
    for i in range(s.size):
        if best is None or s[i] > best:
            best = s[i]
    return best


def used_as_a_whole(s):
    return np.exp(s)


def one_or_the_other(s, p, c):
    if c > 0.0:
        q = s
    else:
        q = p
    return q.u[0]


def int_that_becomes_a_float(s):
    s["n"] += 0.5


def array_as_a_list(s):
    return np.sum(s) / s.size


def logged(s):
    return s.log[0]


def unknown_method(s):
    return s.norm()


def new_key(s):
    s["x"] = 1.0


def membership(s):
    return 1.0 if "x" in s.u else 0.0


def chosen(s, p, c):
    q = s if c > 0.0 else p
    return q.u[0]


def left_early(s):
    total = 0.0
    for part in s:
        if part.u[0] > 1.0:
            break
        total += part.u[0]
    return total


U = array([1.0, 2.0])
@dataclass
class Counted:
    total: float
    count: int = 0
    scale: float = 2.0

    @property
    def mean(self):
        return self.total / self.count

    @mean.setter
    def mean(self, value):
        self.total = value * self.count


def items_that_begin_as_constants(x):
    q, d = Counted(1.0), {"sum": 0.0, "power": 2, "last": {"x": 0.0}, "high": False}
    best = {"value": 0.0, "place": 0}
    for i in range(3):
        q.total = q.total * x[i]
        q.count += 1
        q.count = q.count + 1
        d["sum"] += x[i] ** d["power"]
        d["last"]["x"] = d["last"]["x"] + d["sum"]
        if x[i] ** 2 > best["value"]:
            best["value"], best["place"] = x[i] ** 2, i
            d["high"] = x[i] > 1.0
        part = Counted(0.0)
        part.total += x[i] * q.scale
        q.scale = part.total
    return q.total * q.count + d["last"]["x"] * best["value"] * x[best["place"] - 1] * q.scale * (2 if d["high"] else 3)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_items_that_begin_as_constants(engine):
    check_derivatives(items_that_begin_as_constants, (np.array([0.5, 1.2, 0.9]),), ("x",), ("return",), engine)


def property_assigned(q, x):
    q.mean = x[1]
    return q.total * x[2]


def property_of_a_local(x):
    q = Counted(x[0], 2)
    q.mean = x[1]
    return q.total * x[2]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel, arguments", [(property_assigned, (Counted(0.7, 2), np.array([0.3, 0.5, 0.9]))),
                                               (property_of_a_local, (np.array([0.3, 0.5, 0.9]),))])
def test_a_property_with_a_setter_is_assigned(kernel, arguments, engine):
    with running(engine) as name:
        found = gradient(differentiate(kernel, engine=name), wrt="x")(*arguments)
    assert found == pytest.approx(np.array([0.0, 2.0 * 0.9, 2.0 * 0.5]))
    assert arguments[0] is not Counted or arguments[0].total == 0.7


@dataclass
class Sized:
    a: float

    def __len__(self):
        return 0


def truth_of_its_own(q, x):
    return x[0] if q else x[1] * q.a


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_the_truth_of_an_object_that_defines_it(engine):
    with running(engine) as name:
        assert list(gradient(differentiate(truth_of_its_own, engine=name), wrt="x")(Sized(0.3), np.ones(2))) == [0, 0.3]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_what_structures_hold_in_the_end(engine):
    with running(engine) as name:
        f, g, h = (differentiate(k, engine=name) for k in (none_or_not, picked_by_a_number, left_early))
        assert list(vjp(f, (np.array([1.0, 3.0, 2.0]),), {"return": 2.0})["s"]) == [0, 2, 0]
        found = vjp(g, (SimpleNamespace(n=2, layers=[U, 2.0 * U]),), {"return": np.array([3.0, 4.0])})["s"]
        assert [list(layer) for layer in found.layers] == [[3, 4], [3, 4]]
        parts = tuple(State(np.array([k, 1.0]), U, 0.0) for k in (0.5, 0.7, 1.5, 0.2))
        assert [part.u[0] for part in vjp(h, (parts,), {"return": 1.0})["s"]] == [1, 1, 0, 0]


@pytest.mark.parametrize(("kernel", "s", "seed"), [
    (replaced_array, state_of(), make_zero(state_of())),
    (int_that_becomes_a_float, {"n": 1, "k": 2.0}, {"n": 1, "k": 0.0}),
    (new_key, {"k": 1.0}, {"k": 1.0})])
def test_an_object_that_holds_something_else_in_the_end_is_no_output(kernel, s, seed):
    before = repr(s)
    with pytest.raises(S2sadError) as caught:
        vjp(differentiate(kernel, engine="numpy"), (s,), {"s": seed})
    assert caught.value.diagnostics[0].message == (
        f"'{kernel.__name__}' leaves something else in 's' than was there, which is no output")
    assert repr(s) == before


REFUSED = [
    (field_that_is_not_there, (state_of(),), "s.uu", "S202", "'s' has no field 'uu'",
     "its fields are u, v, t, n, log"),
    (key_that_is_not_there, ({"k": 1.0},), 's["kk"]', "S202", "'s' has no key 'kk'", "its keys are k"),
    (item_that_is_not_there, ((1.0, 2.0),), "s[2]", "S203", "'s' has 2 items, and no item 2", ""),
    (assigned_to_a_named_tuple, (params(),), "s.k", "S201", "'s' is a named tuple, to which nothing can be assigned",
     "return the new value"),
    (attribute_of_an_array, (U,), "s.a", "S201", "an assignment to the attribute .a is not supported in a kernel",
     "return the value, or write it to an element of an array argument"),
    (used_as_a_whole, ({"k": 1.0},), "s", "S203", "'s' is a dict, which is used as a whole here",
     "name what is in it: s['k']"),
    (used_as_a_whole, (state_of(),), "s", "S203", "'s' is a dataclass, which is used as a whole here",
     "name what is in it: s.u, s.v, s.t, s.n, ..."),
    (one_or_the_other, (state_of(), state_of(), 1.0), "q", "S203", "'q' is one thing on one way to here and another on "
     "another, one of them a structure or None", "give the two different names"),
    (array_as_a_list, ([1.0, 2.0],), "s.size", "S203", "'s' is a list, which has no attribute 'size' in a kernel",
     "pass numpy.array(s, dtype=float)"),
    (logged, (State(U, U, 0.0, log=print),), "s.log", "S203",
     "'s.log' is a builtin_function_or_method, which a kernel cannot use",
     "keep what the kernel reads in arrays, floats and ints"),
    (logged, (state_of(),), "s.log", "S203", "'s.log' is None here", "test it before: if s.log is not None: ..."),
    (unknown_method, (Orbit(1.0, 2.0),), "s.norm()", "S201",
     "the method 'norm' of 's', which is a named tuple, is not supported in a kernel",
     "write what it does with s.x, s.v"),
    (membership, (state_of(),), '"x" in s.u', "S201", "'in' is not supported in a kernel",
     "write the comparisons out: x == a or x == b"),
    (chosen, (state_of(), state_of(), 1.0), "s if c > 0.0 else p", "S201",
     "a structure or None is chosen by a test that is known only when the kernel runs",
     "write an if with the whole work in each branch"),
]


@pytest.mark.parametrize(("kernel", "arguments", "marked", "code", "message", "help"), REFUSED,
                         ids=[f"{r[0].__name__}{n}" for n, r in enumerate(REFUSED)])
def test_refused(kernel, arguments, marked, code, message, help):
    with pytest.raises(S2sadError) as caught:
        vjp(differentiate(kernel, engine="numpy"), arguments, {"return": 1.0})
    found = caught.value.diagnostics[0]
    assert (found.code, found.message, found.help) == (code, message, help)
    assert found.span is not None
    assert found.span.source.line(found.span.line)[found.span.column:].startswith(marked)


def test_a_refusal_in_full():
    line = none_used.__code__.co_firstlineno + 1
    refused(f"{__file__}:{line}:21: error[S203]: 'w' is None here\n  {line} |     return s[\"k\"] * w\n"
            f"  {' ' * len(str(line))} |                     ^\n  help: test it before: if w is not None: ...",
            vjp, differentiate(none_used, engine="numpy"), ({"k": 1.0}, None), {"return": 1.0})


@pytest.mark.parametrize(("call", "text"), [
    (lambda f, a: gradient(f, wrt="state.uu")(*a), "error[S401]: wrt names 'state.uu', and 'state' has no such part\n"
     "  help: its parts are state.u, state.v, state.t, state.n, state.log"),
    (lambda f, a: gradient(f, wrt="other")(*a), "error[S401]: wrt names 'other', which is no parameter of 'loss'\n"
     "  help: its parameters are state, p, dt, opts, mask"),
    (lambda f, a: gradient(f, wrt="state.n")(*a), "error[S401]: wrt names 'state.n', which is an integer\n"
     "  help: give a float (3.0, not 3) if it is a real quantity"),
    (lambda f, a: vjp(f, a, {"p": params()}), "error[S401]: 'p' is no output of 'loss', which writes no float in it"),
    (lambda f, a: vjp(f, a, {"state": params()}), "error[S403]: the seed of 'state' is of type Params or has other "
     "parts: 'state' is a dataclass\n  help: make one with s2sad.make_zero(state)"),
    (lambda f, a: vjp(f, a, {"state": State(np.ones(2), U, 0.0)}), "error[S403]: the seed of 'state.u' is an array of "
     "float64 of shape (2,), its output one of float64 of shape (3,)\n  help: give an array of float64 of shape (3,)"),
    (lambda f, a: jvp(f, a, {"state": state_of(), "p": {"k": 1.0}}), "error[S403]: the tangent of 'p' is of type dict "
     "or has other parts: 'p' is a named tuple\n  help: make one with s2sad.make_zero(p)"),
    (lambda f, a: autodiff(Reverse, f, *a), "error[S402]: the argument 'state' has no annotation\n"
     "  help: say Const(state) or Duplicated(state, state_bar)"),
    (lambda f, a: autodiff(Reverse, f, Const(a[0]), Duplicated(a[1], make_zero(a[1])), Active(0.1), Const(a[3])),
     "error[S402]: the float 'p.k' lies in a named tuple: its adjoint cannot be added to the shadow\n"
     "  help: use s2sad.vjp or s2sad.gradient, which return it, or hold 'p.k' in an array"),
    (lambda f, a: autodiff(Reverse, f, Duplicated(a[0], a[0]), Const(a[1]), Const(0.1), Const(a[3])),
     "error[S404]: the argument 'state.u' and the shadow 'state_u_bar' share memory\n"
     "  help: give each shadow memory of its own: s2sad.make_zero(x)"),
    (lambda f, a: f.adjoint(*a), "error[S405]: 'loss.adjoint' was given 4 arguments that do not fit its signature\n"
     "  help: call loss.adjoint(state, p, dt, opts, mask, with a shadow after each that holds float arrays)"),
    (lambda f, a: gradient(f)(*a[:3], {"scale": [0.7] * 600}), "error[S405]: the argument 'opts' is a dict of 600 "
     "values\n  help: pass numpy.array(opts, dtype=float)"),
])
def test_refused_calls(call, text):
    refused(text, call, differentiate(loss, engine="numpy"), (state_of(), params(), 0.1, {"scale": 0.7}))


def weighted(a, state, sequence):
    """Asks what an argument is; two arrays with as many axes stand one behind the other."""
    rows, columns = sequence.shape
    total = 0.0 if state is None else np.sum(state[0] * a)
    for t in range(rows):
        total += np.sum(sequence[t] * a * a)
    return total / columns


def test_an_array_behind_another_that_could_be_its_shadow():
    f = differentiate(weighted, wrt="a", of="return", engine="numpy")
    a_bar = np.zeros(3)
    f.adjoint(np.ones(3), a_bar, np.ones((2, 3)), np.full((4, 3), 2.0), 1.0)
    assert a_bar == pytest.approx(np.full(3, 17.0 / 3.0))
    with pytest.raises(S2sadError, match="a float64 cannot be indexed"):
        f.adjoint(np.ones(3), np.zeros(3), np.ones((2, 3)), 1.0, 1.0)
