"""Shallow water on a staggered grid with friction, forward-backward in time, solid walls."""
import numpy as np


def initial(n):
    x = np.linspace(-1.0, 1.0, n)
    eta = 0.1 * np.exp(-8.0 * (x[:, None] ** 2 + x[None, :] ** 2))
    depth = 1.0 + 0.2 * x[:, None] + 0.1 * np.cos(3.0 * x)[None, :]
    return eta, np.zeros((n + 1, n)), np.zeros((n, n + 1)), depth


def divergence(h, u, v, dx):
    """Of the flux of water; h at the centres, velocities at the faces."""
    flux_x = np.zeros_like(u)
    flux_y = np.zeros_like(v)
    flux_x[1:-1] = 0.5 * (h[1:] + h[:-1]) * u[1:-1]
    flux_y[:, 1:-1] = 0.5 * (h[:, 1:] + h[:, :-1]) * v[:, 1:-1]
    return (np.diff(flux_x, axis=0) + np.diff(flux_y, axis=1)) / dx


def shallow_water(eta, u, v, depth, drag, dx=0.1, dt=0.01, g=9.81, steps=4):
    """Surface and velocities advanced in place; returns the energy that is left."""
    for _ in range(steps):
        h = depth + eta
        u[1:-1] -= dt * (g * (eta[1:] - eta[:-1]) / dx)
        v[:, 1:-1] -= dt * (g * (eta[:, 1:] - eta[:, :-1]) / dx)
        u *= 1.0 - dt * drag * np.abs(u)
        v *= 1.0 - dt * drag * np.abs(v)
        eta -= dt * divergence(h, u, v, dx)
    kinetic = 0.25 * depth * (u[1:] ** 2 + u[:-1] ** 2 + v[:, 1:] ** 2 + v[:, :-1] ** 2)
    return np.sum(kinetic + 0.5 * g * eta ** 2) * dx ** 2
