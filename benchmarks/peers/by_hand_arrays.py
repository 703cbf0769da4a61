"""Adjoints by hand of the kernels of whole arrays: loops over cells, and products of matrices as such."""
from __future__ import annotations

from typing import Any

import numpy as np


def glacier(thickness, thickness_bar, bed, bed_bar, rate, balance, balance_bar, dx, dt, steps):
    n, m = thickness.shape
    unit = 2.0 * (917.0 * 9.81) ** 3 / 5.0
    factor, factor_bar = rate * unit, 0.0
    kept = np.empty((steps + 1, n, m))
    x, y, flow = np.empty((n - 1, m)), np.empty((n, m - 1)), np.empty((n - 1, m - 1))
    x_bar, y_bar, flow_bar = np.empty_like(x), np.empty_like(y), np.empty_like(flow)
    kept[0] = thickness
    for s in range(steps):
        flowing(kept[s], bed, factor, dx, x, y, flow)
        kept[s + 1] = kept[s]
        for i in range(1, n - 1):
            for j in range(1, m - 1):
                change = -0.5 * ((flow[i, j] + flow[i, j - 1]) * x[i, j] - (flow[i - 1, j] + flow[i - 1, j - 1])
                                 * x[i - 1, j] + (flow[i, j] + flow[i - 1, j]) * y[i, j]
                                 - (flow[i, j - 1] + flow[i - 1, j - 1]) * y[i, j - 1]) / dx
                kept[s + 1, i, j] = max(kept[s, i, j] + dt * (balance[i - 1, j - 1] - change), 0.0)
    for s in range(steps - 1, -1, -1):
        flowing(kept[s], bed, factor, dx, x, y, flow)
        x_bar[:], y_bar[:], flow_bar[:] = 0.0, 0.0, 0.0
        for i in range(1, n - 1):
            for j in range(1, m - 1):
                if kept[s + 1, i, j] <= 0.0:
                    thickness_bar[i, j] = 0.0
                g = 0.5 * dt / dx * thickness_bar[i, j]
                balance_bar[i - 1, j - 1] += dt * thickness_bar[i, j]
                flow_bar[i, j] += g * (x[i, j] + y[i, j])
                flow_bar[i, j - 1] += g * (x[i, j] - y[i, j - 1])
                flow_bar[i - 1, j] += g * (y[i, j] - x[i - 1, j])
                flow_bar[i - 1, j - 1] -= g * (x[i - 1, j] + y[i, j - 1])
                x_bar[i, j] += g * (flow[i, j] + flow[i, j - 1])
                x_bar[i - 1, j] -= g * (flow[i - 1, j] + flow[i - 1, j - 1])
                y_bar[i, j] += g * (flow[i, j] + flow[i - 1, j])
                y_bar[i, j - 1] -= g * (flow[i, j - 1] + flow[i - 1, j - 1])
        factor_bar += flowing_back(kept[s], thickness_bar, bed_bar, factor, dx, x, y, flow_bar, x_bar, y_bar)
    return factor_bar * unit


def flowing(thickness, bed, factor, dx, x, y, flow):
    n, m = thickness.shape
    for i in range(n - 1):
        for j in range(m):
            x[i, j] = (bed[i + 1, j] + thickness[i + 1, j] - bed[i, j] - thickness[i, j]) / dx
    for i in range(n):
        for j in range(m - 1):
            y[i, j] = (bed[i, j + 1] + thickness[i, j + 1] - bed[i, j] - thickness[i, j]) / dx
    for i in range(n - 1):
        for j in range(m - 1):
            along, across = 0.5 * (x[i, j] + x[i, j + 1]), 0.5 * (y[i, j] + y[i + 1, j])
            mean = 0.25 * (thickness[i, j] + thickness[i + 1, j] + thickness[i, j + 1] + thickness[i + 1, j + 1])
            flow[i, j] = factor * mean ** 5 * (along * along + across * across)


def flowing_back(thickness, thickness_bar, bed_bar, factor, dx, x, y, flow_bar, x_bar, y_bar):
    n, m = thickness.shape
    factor_bar = 0.0
    for i in range(n - 1):
        for j in range(m - 1):
            along, across = 0.5 * (x[i, j] + x[i, j + 1]), 0.5 * (y[i, j] + y[i + 1, j])
            mean = 0.25 * (thickness[i, j] + thickness[i + 1, j] + thickness[i, j + 1] + thickness[i + 1, j + 1])
            fourth, square, g = mean ** 4, along * along + across * across, flow_bar[i, j]
            factor_bar += g * fourth * mean * square
            of_mean = 1.25 * factor * g * fourth * square
            thickness_bar[i, j] += of_mean
            thickness_bar[i + 1, j] += of_mean
            thickness_bar[i, j + 1] += of_mean
            thickness_bar[i + 1, j + 1] += of_mean
            of_square = factor * g * fourth * mean
            x_bar[i, j] += of_square * along
            x_bar[i, j + 1] += of_square * along
            y_bar[i, j] += of_square * across
            y_bar[i + 1, j] += of_square * across
    for i in range(n):
        for j in range(m):
            g = 0.0
            g += x_bar[i - 1, j] / dx if i > 0 else 0.0
            g -= x_bar[i, j] / dx if i < n - 1 else 0.0
            g += y_bar[i, j - 1] / dx if j > 0 else 0.0
            g -= y_bar[i, j] / dx if j < m - 1 else 0.0
            thickness_bar[i, j] += g
            bed_bar[i, j] += g
    return factor_bar


CX, CY = np.array([0, 1, 0, -1, 0, 1, -1, -1, 1]), np.array([0, 0, 1, 0, -1, 1, 1, -1, -1])
WEIGHT = np.array([4 / 9] + [1 / 9] * 4 + [1 / 36] * 4)


def lattice(f, f_bar, omega, steps):
    kept, g = np.empty((steps, *f.shape)), np.empty_like(f)
    omega_bar = 0.0
    for s in range(steps):
        moved(f, kept[s], 1)
        collided(kept[s], f, omega)
    for s in range(steps - 1, -1, -1):
        omega_bar += collided_back(kept[s], f_bar, omega)
        moved(f_bar, g, -1)
        f_bar[:] = g
    return omega_bar


def moved(f, g, way):
    n, m = f.shape[1:]
    for q in range(9):
        for i in range(n):
            k = (i - way * CX[q]) % n
            for j in range(m):
                place = j - way * CY[q]
                g[q, i, j] = f[q, k, place if 0 <= place < m else place % m]


def collided(f, g, omega):
    for i in range(f.shape[1]):
        for j in range(f.shape[2]):
            rho, x, y = 0.0, 0.0, 0.0
            for q in range(9):
                rho += f[q, i, j]
                x += CX[q] * f[q, i, j]
                y += CY[q] * f[q, i, j]
            x, y = x / rho, y / rho
            for q in range(9):
                cu = 3.0 * (CX[q] * x + CY[q] * y)
                even = rho * WEIGHT[q] * (1.0 + cu + 0.5 * cu * cu - 1.5 * (x * x + y * y))
                g[q, i, j] = f[q, i, j] + omega * (even - f[q, i, j])


def collided_back(f, f_bar, omega):
    omega_bar = 0.0
    for i in range(f.shape[1]):
        for j in range(f.shape[2]):
            rho, x, y, rho_bar, x_bar, y_bar = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for q in range(9):
                rho += f[q, i, j]
                x += CX[q] * f[q, i, j]
                y += CY[q] * f[q, i, j]
            x, y = x / rho, y / rho
            for q in range(9):
                cu = 3.0 * (CX[q] * x + CY[q] * y)
                share = WEIGHT[q] * (1.0 + cu + 0.5 * cu * cu - 1.5 * (x * x + y * y))
                seed = f_bar[q, i, j]
                omega_bar += seed * (rho * share - f[q, i, j])
                rho_bar += omega * seed * share
                slope = 3.0 * omega * seed * rho * WEIGHT[q]
                x_bar += slope * ((1.0 + cu) * CX[q] - x)
                y_bar += slope * ((1.0 + cu) * CY[q] - y)
            rho_bar -= (x_bar * x + y_bar * y) / rho
            for q in range(9):
                f_bar[q, i, j] = (1.0 - omega) * f_bar[q, i, j] + rho_bar + (x_bar * CX[q] + y_bar * CY[q]) / rho
    return omega_bar


def attention(out, out_bar, q, q_bar, k, k_bar, v, v_bar):
    scale = 1.0 / np.sqrt(q.shape[1])
    weight = (q @ k.T) * scale
    weight -= np.max(weight, axis=1, keepdims=True)
    np.exp(weight, out=weight)
    weight /= np.sum(weight, axis=1, keepdims=True)
    v_bar += weight.T @ out_bar
    score_bar = out_bar @ v.T
    score_bar -= np.sum(weight * score_bar, axis=1, keepdims=True)
    score_bar *= weight
    score_bar *= scale
    q_bar += score_bar @ k
    k_bar += score_bar.T @ q


PRODUCTS = {"attention"}
KERNELS: dict[str, Any] = {f.__name__: f for f in (glacier, lattice, attention)}
