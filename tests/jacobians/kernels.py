"""Kernels with Jacobians of many kinds: stencils, rings, what data decide, numbers and arrays."""
from __future__ import annotations

import numpy as np


def brusselator(du, u, p):
    n = u.shape[0]
    for i in range(n):
        for j in range(n):
            ip, im = (i + 1) % n, (i - 1) % n
            jp, jm = (j + 1) % n, (j - 1) % n
            v, w = u[i, j, 0], u[i, j, 1]
            du[i, j, 0] = p[2] * (u[im, j, 0] + u[ip, j, 0] + u[i, jp, 0] + u[i, jm, 0] - 4 * v) + (
                p[1] + v ** 2 * w - (p[0] + 1) * v)
            du[i, j, 1] = p[2] * (u[im, j, 1] + u[ip, j, 1] + u[i, jp, 1] + u[i, jm, 1] - 4 * w) + (
                p[0] * v - v ** 2 * w)


def in_place(u, c):
    for i in range(1, u.size):
        u[i] = u[i] * u[i - 1] + c


def of_numbers(a, b):
    return np.sin(a) * b


def to_an_array(x):
    y = np.zeros((x.shape[0], 2))
    for i in range(x.shape[0]):
        y[i, 0] = x[i, 0] * x[i, 1] ** 2
        y[i, 1] = np.exp(x[i - 1, 1])
    return y


def to_a_number(x):
    s = 0.0
    for i in range(1, x.size):
        s += x[i] ** 2 * x[i - 1]
    return s


def upwind(du, u):
    for i in range(1, u.size - 1):
        if u[i] > 0.0:
            du[i] = u[i] * (u[i] - u[i - 1])
        else:
            du[i] = u[i] * (u[i + 1] - u[i])


def energy(x, k):
    """Springs between neighbours, and a wall."""
    total = 0.0
    for i in range(1, x.size):
        gap = x[i] - x[i - 1]
        total += k * gap ** 4 + np.exp(-gap)
    for i in range(x.size):
        if x[i] > 1.0:
            total += (x[i] - 1.0) ** 3
    return total


def after_steps(u, p, steps):
    v = u.copy()
    for _ in range(steps):
        for i in range(1, v.size - 1):
            v[i] = v[i] + 0.1 * p[0] * (v[i - 1] * v[i + 1] - v[i] ** 2)
    return np.sum(v ** 2 * p[1])


def fields(u):
    work = np.empty_like(u)
    work[1:] = np.sqrt(u[1:] ** 2 + u[:-1])
    work[0] = u[0] ** 3
    return np.sum(work * u)


def arrow(du, u):
    """Everything meets the first variable, and the first rate meets everything."""
    du[0] = 0.0
    for i in range(u.size):
        du[0] += u[i] ** 3
    for i in range(1, u.size):
        du[i] = u[0] * u[i] - u[i] ** 2


def pick(u, k):
    """What is given comes back."""
    if k > 0.0:
        u[0] = k * u[0]
    return u


def given_back(u):
    return u
