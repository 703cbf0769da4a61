"""Kernels that read, assign, hand over and return structures, with arguments."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from tests.evaluate.structures.arguments import (
    LAYERS, X, Layer, Loss, Orbit, Spring, State, array, model, params, state_of,
)


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
