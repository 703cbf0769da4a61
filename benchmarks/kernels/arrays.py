"""Whole-array kernels and the mix in the middle: slices, views, broadcasting and linear algebra
beside element loops and in-place writes."""
import numpy as np


def gray_scott(u, v, steps, du, dv, feed, kill):
    """Views bound to names, padded arrays, periodic halo, in-place updates."""
    inner_u, inner_v = u[1:-1, 1:-1], v[1:-1, 1:-1]
    for _ in range(steps):
        for w in (u, v):
            w[0, :] = w[-2, :]
            w[-1, :] = w[1, :]
            w[:, 0] = w[:, -2]
            w[:, -1] = w[:, 1]
        lap_u = u[:-2, 1:-1] + u[1:-1, :-2] - 4.0 * inner_u + u[1:-1, 2:] + u[2:, 1:-1]
        lap_v = v[:-2, 1:-1] + v[1:-1, :-2] - 4.0 * inner_v + v[1:-1, 2:] + v[2:, 1:-1]
        reaction = inner_u * inner_v ** 2
        inner_u += du * lap_u - reaction + feed * (1.0 - inner_u)
        inner_v += dv * lap_v + reaction - (feed + kill) * inner_v


def glacier(thickness, bed, rate, balance, dx, dt, steps):
    """Shallow-ice flow of a glacier (isothermal, Glen's n = 3), explicit in time, thickness in place:
    staggered slopes, a power law, non-negative thickness."""
    density, gravity = 917.0, 9.81
    factor = 2.0 * rate * (density * gravity) ** 3 / 5.0
    for _ in range(steps):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = np.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                        + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep ** 2
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        thickness[1:-1, 1:-1] = np.maximum(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0)


def neural_diffusion(u, w1, b1, w2, b2, dt, steps):
    """A universal differential equation: the diffusivity is a small network, the update a loop in place."""
    n = u.size
    flux = np.zeros(n + 1)
    for _ in range(steps):
        hidden = np.tanh(w1 @ u.reshape(1, n) + b1[:, None])
        diffusivity = np.exp(w2 @ hidden + b2)[0]
        for i in range(1, n):
            flux[i] = 0.5 * (diffusivity[i] + diffusivity[i - 1]) * (u[i] - u[i - 1])
        for i in range(n):
            u[i] += dt * (flux[i + 1] - flux[i])
    return np.sum(u ** 2)


def implicit_heat(u, conductivity, dt, steps):
    """A matrix filled in place by a loop, then a dense solve per step: linear algebra in mutating code."""
    n = u.size
    matrix = np.zeros((n, n))
    for _ in range(steps):
        matrix[:] = 0.0
        for i in range(n):
            left = conductivity[i] * (1.0 + u[i] ** 2)
            right = conductivity[i + 1] * (1.0 + u[i] ** 2)
            matrix[i, i] = 1.0 + dt * (left + right)
            if i > 0:
                matrix[i, i - 1] = -dt * left
            if i < n - 1:
                matrix[i, i + 1] = -dt * right
        u[:] = np.linalg.solve(matrix, u)


def attention(out, q, k, v):
    """Softmax attention row by row, with a maximum, a sum and a matrix product."""
    scale = 1.0 / np.sqrt(q.shape[1])
    for i in range(q.shape[0]):
        score = (k @ q[i]) * scale
        weight = np.exp(score - np.max(score))
        weight /= np.sum(weight)
        out[i, :] = weight @ v


def masked_flow(head, depth, conductance, steps):
    """Boolean masks, where, clip, and reductions with an axis."""
    for _ in range(steps):
        dry = depth < 0.05
        speed = np.where(dry, 0.0, np.sqrt(np.maximum(depth, 0.0)))
        speed[dry] *= 0.5
        head += conductance * (np.mean(speed, axis=1, keepdims=True) - speed)
        depth[1:, :] -= 0.1 * np.clip(head[1:, :] - head[:-1, :], -1.0, 1.0) * depth[1:, :]
    return np.sum(head * depth)


def lattice(f, omega, steps):
    """D2Q9 lattice Boltzmann: roll, reductions over the first axis, outer broadcasting."""
    cx = np.array([0, 1, 0, -1, 0, 1, -1, -1, 1])
    cy = np.array([0, 0, 1, 0, -1, 1, 1, -1, -1])
    weight = np.array([4 / 9] + [1 / 9] * 4 + [1 / 36] * 4)
    for _ in range(steps):
        for q in range(9):
            f[q] = np.roll(np.roll(f[q], cx[q], axis=0), cy[q], axis=1)
        rho = np.sum(f, axis=0)
        ux = np.sum(f * cx[:, None, None], axis=0) / rho
        uy = np.sum(f * cy[:, None, None], axis=0) / rho
        for q in range(9):
            cu = 3.0 * (cx[q] * ux + cy[q] * uy)
            f[q] += omega * (rho * weight[q] * (1.0 + cu + 0.5 * cu ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - f[q])
