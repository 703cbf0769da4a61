"""Stencils, sweeps and filters: PolyBench's and those of weather codes, as NumPy users write them (NPBench), and flux
limiters and an implicit scheme of textbooks (R. LeVeque, Finite Volume Methods, 2002)."""
from __future__ import annotations

import numpy as np


def jacobi_1d(steps, A, B):
    for _ in range(1, steps):
        B[1:-1] = 0.33333 * (A[:-2] + A[1:-1] + A[2:])
        A[1:-1] = 0.33333 * (B[:-2] + B[1:-1] + B[2:])


def jacobi_2d(steps, A, B):
    for _ in range(1, steps):
        B[1:-1, 1:-1] = 0.2 * (A[1:-1, 1:-1] + A[1:-1, :-2] + A[1:-1, 2:] + A[2:, 1:-1] + A[:-2, 1:-1])
        A[1:-1, 1:-1] = 0.2 * (B[1:-1, 1:-1] + B[1:-1, :-2] + B[1:-1, 2:] + B[2:, 1:-1] + B[:-2, 1:-1])


def heat_3d(steps, A, B):
    for _ in range(1, steps):
        B[1:-1, 1:-1, 1:-1] = (0.125 * (A[2:, 1:-1, 1:-1] - 2.0 * A[1:-1, 1:-1, 1:-1] + A[:-2, 1:-1, 1:-1])
                               + 0.125 * (A[1:-1, 2:, 1:-1] - 2.0 * A[1:-1, 1:-1, 1:-1] + A[1:-1, :-2, 1:-1])
                               + 0.125 * (A[1:-1, 1:-1, 2:] - 2.0 * A[1:-1, 1:-1, 1:-1] + A[1:-1, 1:-1, :-2])
                               + A[1:-1, 1:-1, 1:-1])
        A[1:-1, 1:-1, 1:-1] = (0.125 * (B[2:, 1:-1, 1:-1] - 2.0 * B[1:-1, 1:-1, 1:-1] + B[:-2, 1:-1, 1:-1])
                               + 0.125 * (B[1:-1, 2:, 1:-1] - 2.0 * B[1:-1, 1:-1, 1:-1] + B[1:-1, :-2, 1:-1])
                               + 0.125 * (B[1:-1, 1:-1, 2:] - 2.0 * B[1:-1, 1:-1, 1:-1] + B[1:-1, 1:-1, :-2])
                               + B[1:-1, 1:-1, 1:-1])


def seidel_2d(steps, A):
    n = A.shape[0]
    for _ in range(steps - 1):
        for i in range(1, n - 1):
            A[i, 1:-1] += A[i - 1, :-2] + A[i - 1, 1:-1] + A[i - 1, 2:] + A[i, 2:] + A[i + 1, :-2] + A[i + 1, 1:-1] \
                + A[i + 1, 2:]
            for j in range(1, n - 1):
                A[i, j] += A[i, j - 1]
                A[i, j] /= 9.0


def fdtd_2d(ex, ey, hz, fict):
    for t in range(fict.shape[0]):
        ey[0, :] = fict[t]
        ey[1:, :] -= 0.5 * (hz[1:, :] - hz[:-1, :])
        ex[:, 1:] -= 0.5 * (hz[:, 1:] - hz[:, :-1])
        hz[:-1, :-1] -= 0.7 * (ex[:-1, 1:] - ex[:-1, :-1] + ey[1:, :-1] - ey[:-1, :-1])


def adi(steps, u):
    n = u.shape[0]
    v, p, q = np.empty_like(u), np.empty_like(u), np.empty_like(u)
    dx, dt = 1.0 / n, 1.0 / steps
    mul = 0.2 * dt / (dx * dx) * 1e-2
    a, b = -mul / 2.0, 1.0 + mul
    for _ in range(steps):
        v[0, 1:-1] = 1.0
        p[1:-1, 0] = 0.0
        q[1:-1, 0] = v[0, 1:-1]
        for j in range(1, n - 1):
            p[1:-1, j] = -a / (a * p[1:-1, j - 1] + b)
            q[1:-1, j] = (-a * u[j, :-2] + (1.0 + 2.0 * a) * u[j, 1:-1] - a * u[j, 2:]
                          - a * q[1:-1, j - 1]) / (a * p[1:-1, j - 1] + b)
        v[n - 1, 1:-1] = 1.0
        for j in range(n - 2, 0, -1):
            v[j, 1:-1] = p[1:-1, j] * v[j + 1, 1:-1] + q[1:-1, j]
        u[1:-1, 0] = 1.0
        p[1:-1, 0] = 0.0
        q[1:-1, 0] = u[1:-1, 0]
        for j in range(1, n - 1):
            p[1:-1, j] = -a / (a * p[1:-1, j - 1] + b)
            q[1:-1, j] = (-a * v[:-2, j] + (1.0 + 2.0 * a) * v[1:-1, j] - a * v[2:, j]
                          - a * q[1:-1, j - 1]) / (a * p[1:-1, j - 1] + b)
        u[1:-1, n - 1] = 1.0
        for j in range(n - 2, 0, -1):
            u[1:-1, j] = p[1:-1, j] * u[1:-1, j + 1] + q[1:-1, j]


def deriche(alpha, image):
    """A recursive edge filter (R. Deriche, 1987): two passes along the rows, two along the columns."""
    k = (1.0 - np.exp(-alpha)) * (1.0 - np.exp(-alpha)) / (1.0 + alpha * np.exp(-alpha) - np.exp(2.0 * alpha))
    a1, a2 = k, k * np.exp(-alpha) * (alpha - 1.0)
    a3, a4 = k * np.exp(-alpha) * (alpha + 1.0), -k * np.exp(-2.0 * alpha)
    b1, b2 = 2.0 ** (-alpha), -np.exp(-2.0 * alpha)
    y1, y2, out = np.zeros_like(image), np.zeros_like(image), np.empty_like(image)
    y1[:, 0] = a1 * image[:, 0]
    y1[:, 1] = a1 * image[:, 1] + a2 * image[:, 0] + b1 * y1[:, 0]
    for j in range(2, image.shape[1]):
        y1[:, j] = a1 * image[:, j] + a2 * image[:, j - 1] + b1 * y1[:, j - 1] + b2 * y1[:, j - 2]
    y2[:, -2] = a3 * image[:, -1]
    for j in range(image.shape[1] - 3, -1, -1):
        y2[:, j] = a3 * image[:, j + 1] + a4 * image[:, j + 2] + b1 * y2[:, j + 1] + b2 * y2[:, j + 2]
    out[:] = y1 + y2
    y1[0, :] = a1 * out[0, :]
    y1[1, :] = a1 * out[1, :] + a2 * out[0, :] + b1 * y1[0, :]
    for i in range(2, image.shape[0]):
        y1[i, :] = a1 * out[i, :] + a2 * out[i - 1, :] + b1 * y1[i - 1, :] + b2 * y1[i - 2, :]
    y2[-1, :] = 0.0
    y2[-2, :] = a3 * out[-1, :]
    for i in range(image.shape[0] - 3, -1, -1):
        y2[i, :] = a3 * out[i + 1, :] + a4 * out[i + 2, :] + b1 * y2[i + 1, :] + b2 * y2[i + 2, :]
    out[:] = y1 + y2
    return out


def hdiff(field, coefficient):
    """Horizontal diffusion of a weather code: a Laplacian, and fluxes that are limited."""
    lap = 4.0 * field[1:-1, 1:-1, :] - (field[2:, 1:-1, :] + field[:-2, 1:-1, :] + field[1:-1, 2:, :]
                                         + field[1:-1, :-2, :])
    res = lap[1:, 1:-1, :] - lap[:-1, 1:-1, :]
    fx = np.where(res * (field[2:-1, 2:-2, :] - field[1:-2, 2:-2, :]) > 0.0, 0.0, res)
    res = lap[1:-1, 1:, :] - lap[1:-1, :-1, :]
    fy = np.where(res * (field[2:-2, 2:-1, :] - field[2:-2, 1:-2, :]) > 0.0, 0.0, res)
    return field[2:-2, 2:-2, :] - coefficient * (fx[1:, :, :] - fx[:-1, :, :] + fy[:, 1:, :] - fy[:, :-1, :])


def vadv(utens, u, w, dt):
    """Vertical advection, implicit: a tridiagonal system in each column."""
    nk = u.shape[2]
    c, d = np.zeros_like(u), np.zeros_like(u)
    gc = 0.25 * w[:, :, 1]
    c[:, :, 0] = gc / (1.0 / dt - gc)
    d[:, :, 0] = (u[:, :, 0] / dt + utens[:, :, 0] - gc * (u[:, :, 1] - u[:, :, 0])) / (1.0 / dt - gc)
    for k in range(1, nk - 1):
        ga, gc = -0.25 * w[:, :, k], 0.25 * w[:, :, k + 1]
        b = 1.0 / dt - ga - gc
        rest = -ga * (u[:, :, k - 1] - u[:, :, k]) - gc * (u[:, :, k + 1] - u[:, :, k])
        divided = 1.0 / (b - c[:, :, k - 1] * ga)
        c[:, :, k] = gc * divided
        d[:, :, k] = (u[:, :, k] / dt + utens[:, :, k] + rest - d[:, :, k - 1] * ga) * divided
    ga = -0.25 * w[:, :, nk - 1]
    d[:, :, nk - 1] = (u[:, :, nk - 1] / dt + utens[:, :, nk - 1] - ga * (u[:, :, nk - 2] - u[:, :, nk - 1])
                       - d[:, :, nk - 2] * ga) / (1.0 / dt - ga - c[:, :, nk - 2] * ga)
    after = d[:, :, nk - 1]
    utens[:, :, nk - 1] = (after - u[:, :, nk - 1]) / dt
    for k in range(nk - 2, -1, -1):
        after = d[:, :, k] - c[:, :, k] * after
        utens[:, :, k] = (after - u[:, :, k]) / dt


def crank_nicolson(u, r, steps):
    """Heat in a rod, half a step explicit and half implicit, the tridiagonal system by elimination."""
    n = u.shape[0]
    c, d = np.zeros(n), np.zeros(n)
    for _ in range(steps):
        for i in range(1, n - 1):
            right = r * u[i - 1] + (2.0 - 2.0 * r) * u[i] + r * u[i + 1]
            m = 2.0 + 2.0 * r + r * c[i - 1]
            c[i] = -r / m
            d[i] = (right + r * d[i - 1]) / m
        for i in range(n - 2, 0, -1):
            u[i] = d[i] - c[i] * u[i + 1]


def tvd(u, c, steps):
    """Advection with van Leer's limiter (1974), periodic."""
    for _ in range(steps):
        du = np.roll(u, -1) - u
        behind = np.roll(du, 1)
        r = behind / (du + 1e-12)
        phi = (r + np.abs(r)) / (1.0 + np.abs(r))
        flux = u + 0.5 * (1.0 - c) * phi * du
        u -= c * (flux - np.roll(flux, 1))
