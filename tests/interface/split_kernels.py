"""Kernels for `f.augmented` and `f.reverse`, which differ in what the reverse sweep takes."""
from __future__ import annotations

from types import SimpleNamespace as State

import numpy as np

TABLE = np.array([1.0, 2.0, 3.0])


def single(x, u, k):
    u[:] = u * x / k
    y = x * x / k
    return y + np.sum(u), y


def early(u, n, flag, mode="a", other=None):
    if flag:
        return u[0] * 2.0
    w = np.zeros(n)
    for i in range(n):
        w[i] = u[i] ** 2
        if w[i] > 5.0:
            return w[i] * u[0]
    if mode == "b" and other is None:
        return np.sum(np.sin(u) * w[0])
    return np.sum(w)


def of_the_module(u):
    for i in range(u.size):
        u[i] = np.exp(u[i] * TABLE[i])
    return u[0] * TABLE[0]


def linear(u, v):
    v[:] = 2.0 * u


def numbers(a, b, n: int):
    c = a
    for k in range(n):
        c = c * b + k
        if c > 100.0:
            break
    return c, n, c > 3.0


def of_complex(z, u):
    w = z * u
    u[:] = w * w
    return np.abs(w[0]) * z


def turned(u, p, m):
    for k in range(m):      # noqa: B007
        u[:] = np.sin(u) * p


def nested(u, p, n, m):
    for j in range(n):      # noqa: B007
        turned(u, p, m)
        u *= 1.1
    return u[0]


def perhaps(u, p, m):
    if u[0] > 0.0:
        turned(u, p, m)
    return u[0] * u[1]


def until(u, p, end):
    t = 0.0
    while t < end:
        u[:] = np.sin(u) * p * t
        t += 0.5
        if u[0] > 1e9:
            break
    return np.sum(u)


def of_sizes(u, n):
    total = 0.0
    for k in range(1, n):
        w = u[:k] * k
        w *= w
        total += np.sum(w)
    return total


def narrow(a, x):
    s = 0.0
    for i in range(a.size):
        b = a[i]
        x[i] = x[i] ** 2 * b
        s += x[i] * b
    return s


def divides(u, dt, n):
    for k in range(n):
        rate = 1.0 / dt
        for i in range(u.size):
            u[i] = u[i] * 0.5 + k * np.exp(-rate) * u[i]
    return u[0]


def returned(u):
    y = np.exp(u)
    return y, np.sum(y * y)


def squares(u, dt):
    for i in range(u.size):
        u[i] += dt * u[i] * u[i]
    return np.sum(u) * dt


def step(state, p, layers, mask=None):
    for w, b in layers:
        for i in range(state.u.size):
            state.u[i] += p["dt"] * np.tanh(w * state.u[i] + b)
    if mask is not None:
        state.u[0] *= mask[0]
    state.t += p["dt"]
    return state.t * np.sum(state.u), [state.u * 2.0, 3]


def made():
    return State(u=np.array([1.0, 2.0]), t=0.5), {"dt": 0.1, "name": "euler"}, [(0.5, 0.1), (2.0, 0.3)]


ONE = np.float32
# each kernel with arguments and the options of `check_split`
CASES = [
    (single, (ONE(1.3), np.arange(1, 4, dtype=ONE), ONE(3.0)), {}),
    (single, (1.5, np.zeros(0), 3.0), {}),
    (early, (np.arange(4.0), 4, True), {}),
    (early, (np.arange(4.0) * 2, 4, False), {}),
    (early, (np.arange(4.0) / 4, 4, False, "b"), {"wrt": "u"}),
    (of_the_module, (np.arange(3.0),), {}),
    (linear, (np.arange(3.0), np.zeros(3)), {}),
    (linear, (np.arange(6.0)[::2], np.zeros((3, 3))[:, 1]), {"wrt": "u", "of": "v"}),
    (numbers, (1.5, 2.0, 5), {}),
    (numbers, (1.5, 2.0, 0), {"wrt": "b"}),
    (of_complex, (1.0 + 2.0j, np.array([1.0 + 1.0j, 2.0])), {}),
    (nested, (np.arange(3.0), 0.7, 4, 5), {}),
    (nested, (np.arange(3.0), 0.7, 4, 5), {"checkpoint": {"j": 2}}),
    (nested, (np.arange(3.0), 0.7, 4, 5), {"checkpoint": {"turned.k": 2, "j": 2}}),
    (nested, (np.arange(3.0), 0.7, 0, 5), {"checkpoint": {"turned.k": 2}}),
    (perhaps, (np.arange(3.0) + 1.0, 0.7, 5), {"checkpoint": {"turned.k": 2}}),
    (perhaps, (np.arange(3.0) - 1.0, 0.7, 5), {"checkpoint": {"turned.k": 2}}),
    (until, (np.arange(3.0) + 1.0, 0.7, 9), {}),
    (of_sizes, (np.arange(4.0), 4), {}),
    (narrow, (np.array([200, 250, 3], np.uint8), np.arange(3.0)), {}),
    (returned, (np.arange(3.0),), {}),
]
