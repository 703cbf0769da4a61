"""Loops over time whose work arrays are filled row by row: an iteration that runs again needs none of what these held,
where it fills all rows before it reads them."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def all_rows(q, steps):
    for _ in range(steps):
        u = q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * q[0] * u ** 2)
        h = (q[2] + p) / q[0]
        flux = np.stack((q[1] * h, q[1] * u + p * u, u * h * (q[2] + p)))
        q[:, 1:-1] -= 0.1 * (flux[:, 2:] - flux[:, :-2]) * u[1:-1] * h[1:-1]


def one_row_of_before(q, steps):
    f = np.ones((3, q.shape[1]))
    for _ in range(steps):
        u = q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * q[0] * u ** 2)
        h = np.exp((q[2] + p) / q[0] * f[2] * 0.01)
        f[0] = q[1] * h * u
        f[1] = q[1] * u + p * u * h
        f[2] = u * h * (q[2] + p) * f[0]
        q[:, 1:-1] -= 0.1 * (f[:, 2:] - f[:, :-2]) * u[1:-1] * h[1:-1]


def one_row_is_left(q, steps):
    f = np.ones((4, q.shape[1]))
    for k in range(steps):
        u = q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * q[0] * u ** 2)
        h = (q[2] + p) / q[0]
        f[0] = q[1] * h * u
        f[1] = q[1] * u + p * u * h
        f[2] = u * h * (q[2] + p)
        q[:, 1:-1] -= 0.1 * (f[:3, 2:] * f[3, 2:] - f[:3, :-2]) * u[1:-1] * h[1:-1]
        if k == 0:
            f[3] = u * h


def row_on_one_side(q, steps):
    f = np.ones((3, q.shape[1]))
    for k in range(steps):
        u = q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * q[0] * u ** 2)
        h = (q[2] + p) / q[0]
        f[0] = q[1] * h * u
        f[1] = q[1] * u + p * u * h
        if k % 2 == 0:
            f[2] = u * h * (q[2] + p)
        q[:, 1:-1] -= 0.1 * (f[:, 2:] - f[:, :-2]) * f[:, 1:-1] * u[1:-1] * h[1:-1]


def part_of_a_row(q, steps):
    f = np.ones((3, q.shape[1]))
    for _ in range(steps):
        u = q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * q[0] * u ** 2)
        h = (q[2] + p) / q[0]
        f[0] = q[1] * h * u
        f[1] = q[1] * u + p * u * h
        f[2, 1:] = (u * h * (q[2] + p))[1:] + 0.1 * f[2, :-1]
        q[:, 1:-1] -= 0.1 * (f[:, 2:] - f[:, :-2]) * f[:, 1:-1] * u[1:-1] * h[1:-1]


def cases():
    rng = generator(82)
    for kernel in (all_rows, one_row_of_before, one_row_is_left, row_on_one_side, part_of_a_row):
        q = 1.0 + 0.1 * rng.random((3, 7))
        yield Case(kernel, (q, 3), ("q",), ("q",))
