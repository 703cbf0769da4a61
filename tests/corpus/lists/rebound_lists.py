"""Lists of arrays that a loop binds anew, as recurrent networks and time steps write them."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(0)
W, U, X, A, ROWS = RNG.random((3, 2)), RNG.random((3, 3)), RNG.random((4, 2)), RNG.random((3, 3)), RNG.random((4, 2))


def recurrent(w, u, x):
    h = np.zeros(w.shape[0])
    states = []
    for t in range(x.shape[0]):
        h = np.tanh(w @ x[t] + u @ h)
        states.append(h)
    return np.sum(np.array(states) ** 2)


def made_before(w, u, x):
    states = []
    h = np.zeros(w.shape[0])
    for t in range(x.shape[0]):
        h = np.tanh(w @ x[t] + u @ h)
        states.append(h)
    return np.sum(np.array(states) ** 2)


def frames(a, n):
    t = np.eye(3)
    found = [t]
    for _ in range(n):
        t = a @ t
        found.append(t.copy())
    return np.sum(found[-1] ** 2) + np.sum(found[1])


def path(x, dt, n):
    y = x.copy()
    points = [y.copy()]
    for _ in range(n):
        y = y + dt * np.sin(y)
        points.append(y)
    p = np.array(points)
    return np.sum(p[:, 0] ** 2)


def mapped(w, rows):
    return np.sum(np.array([w @ r for r in rows]) ** 2)


def mapped_by_a_loop(w, rows):
    found = []
    for i in range(rows.shape[0]):
        found.append(w @ rows[i])
    return np.sum(np.array(found) ** 2) + np.sum(found[1])


def summed_up(rows):
    return np.sum(np.array([np.cumsum(r) for r in rows]) ** 2)


CASES = [(recurrent, (W, U, X), ("w", "u", "x")), (made_before, (W, U, X), ("w", "u", "x")),
         (frames, (A, 3), ("a",)), (path, (A[0], 0.1, 4), ("x", "dt")), (mapped, (W, ROWS), ("w", "rows")),
         (mapped_by_a_loop, (W, ROWS), ("w", "rows")), (summed_up, (ROWS,), ("rows",))]


def cases():
    # gradients
    for kernel, arguments, wrt in CASES:
        yield Case(kernel, arguments, wrt)
