"""Right-hand sides of ordinary differential equations, that write their rate or return it."""
from __future__ import annotations

import numpy as np


def hunters(t, z, p):
    """Lotka and Volterra's, as users of SciPy write it."""
    x, y = z
    return [p[0] * x - p[1] * x * y, p[2] * x * y - p[3] * y]


def hunters_in_place(du, u, p, t):
    du[0] = p[0] * u[0] - p[1] * u[0] * u[1]
    du[1] = p[2] * u[0] * u[1] - p[3] * u[1]


def grid(du, u, k, t):
    """Diffusion and a reaction on a plane, whose rate is added up."""
    for i in range(u.shape[0]):
        for j in range(u.shape[1]):
            du[i, j] += np.sin(t) - u[i, j] ** 3
            if i > 0:
                du[i, j] += k * (u[i - 1, j] - u[i, j])
            if j > 0:
                du[i, j] += k * (u[i, j - 1] - u[i, j])


def number(t, u, k=2.0):
    return -k * u ** 2


def in_a_model(du, u, model, t):
    for i in range(u.size):
        du[i] = -model["k"] * u[i] ** 2 + model["source"][i]


def overwrites_its_state(du, u):
    for i in range(1, u.size):
        u[i] = u[i] * u[i - 1]
    du[:] = -u


def swapped(u, du):
    for i in range(u.size):
        du[i] = -u[i]


def forgets(du, u):
    return u * 2.0


def turned(t, u):
    return u.T * 2.0


def by_name(clock, pace, x, amount):
    for i in range(x.size):
        pace[i] = amount * np.cos(clock) * x[i]


# -- losses, of the states at all times -------------------------------------------------------------------------------

def misfit(us):
    total = 0.0
    for k in range(us.shape[0]):
        total += us[k, 0] ** 2 + np.sin(us[k, 1])
    return total


def of_a_plane(us):
    return np.sum(us[-1] ** 2) + us[1, 0, 1] * us[2, 1, 2]


def forced(t, u, rate, amount):
    """Driven, and with a number and an array among its arguments."""
    return -rate * u ** 2 + amount * np.sin(2.0 * t)


def explodes(t, u, k):
    return k * u ** 2


def roots(t, u, k):
    return -k * np.sqrt(u)


def relaxes(du, u, k, t):
    """Stiff: the second part follows the first one, which is slow, by the rate k."""
    du[0] = np.sin(t) - 0.5 * u[1]
    du[1] = k * (u[0] ** 2 - u[1])
