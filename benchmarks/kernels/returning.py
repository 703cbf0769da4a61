"""Runge-Kutta steps whose right-hand side returns arrays, and the same with arrays that it is given."""
from __future__ import annotations

import numpy as np


def rates(u, p):
    du = np.zeros_like(u)
    n = u.shape[0]
    for i in range(n):
        for j in range(n):
            ip, im, jp, jm = (i + 1) % n, (i - 1) % n, (j + 1) % n, (j - 1) % n
            r = u[i, j, 0] ** 2 * u[i, j, 1]
            du[i, j, 0] = p[0] * (u[im, j, 0] + u[ip, j, 0] + u[i, jp, 0] + u[i, jm, 0] - 4.0 * u[i, j, 0]) + p[1] + (
                r - (p[2] + 1.0) * u[i, j, 0])
            du[i, j, 1] = p[0] * (u[im, j, 1] + u[ip, j, 1] + u[i, jp, 1] + u[i, jm, 1] - 4.0 * u[i, j, 1]) + (
                p[2] * u[i, j, 0] - r)
    return du


def rates_into(du, u, p):
    du[:] = rates(u, p)


def loops(u, p, dt, steps):
    for _ in range(steps):
        a = rates(u, p)
        b = rates(u + 0.5 * dt * a, p)
        c = rates(u + 0.5 * dt * b, p)
        d = rates(u + dt * c, p)
        u += dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return np.sum(u ** 2)


def loops_given(u, p, dt, steps):
    a, b, c, d = np.zeros_like(u), np.zeros_like(u), np.zeros_like(u), np.zeros_like(u)
    for _ in range(steps):
        rates_into(a, u, p)
        rates_into(b, u + 0.5 * dt * a, p)
        rates_into(c, u + 0.5 * dt * b, p)
        rates_into(d, u + dt * c, p)
        u += dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return np.sum(u ** 2)


def spread(u):
    return np.roll(u, 1, axis=0) + np.roll(u, -1, axis=0) + np.roll(u, 1, axis=1) + np.roll(u, -1, axis=1) - 4.0 * u


def flows(u, v, p):
    r = u * v ** 2
    return p[0] * spread(u) - r + p[1] * (1.0 - u), p[0] * spread(v) + r - p[2] * v


def whole(w, p, dt, steps):
    u, v = w[:, :, 0].copy(), w[:, :, 1].copy()
    for _ in range(steps):
        a, b = flows(u, v, p)
        c, d = flows(u + 0.5 * dt * a, v + 0.5 * dt * b, p)
        e, f = flows(u + 0.5 * dt * c, v + 0.5 * dt * d, p)
        g, h = flows(u + dt * e, v + dt * f, p)
        u += dt / 6.0 * (a + 2.0 * c + 2.0 * e + g)
        v += dt / 6.0 * (b + 2.0 * d + 2.0 * f + h)
    return np.sum(u ** 2) + np.sum(v)


KERNELS = {f.__name__: f for f in (loops, loops_given, whole)}
