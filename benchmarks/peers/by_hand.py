"""Adjoints by hand, as one writes them who has the time: loops that gather, only what is needed recorded. The limit."""
from __future__ import annotations

import inspect
from typing import Any

import numpy as np

from benchmarks.calls import adjoint_arguments, fresh, plain_numba
from benchmarks.kernels.brusselator import brusselator as rates
from benchmarks.peers import by_hand_adbench, by_hand_arrays
from benchmarks.peers.ours import restoring
from benchmarks.peers.problems import Problem, Run, Unsupported

forward_rates: Any = plain_numba(rates)


def prepare(variant: str, kernel: str, problem: Problem) -> Run:
    """The adjoint, compiled unless it is products of matrices."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    shadowed = adjoint_arguments(problem.case, problem.arguments)
    assert len(shadowed) == len(inspect.signature(KERNELS[kernel]).parameters)
    adjoint = KERNELS[kernel] if kernel in by_hand_arrays.PRODUCTS else plain_numba(KERNELS[kernel])
    adjoint(*fresh(shadowed))
    return restoring(adjoint, shadowed, problem.case)


def brusselator(du, du_bar, u, u_bar, p, p_bar, t):
    a, alpha, dx = p[0], p[2] / p[3] ** 2, p[3]
    n = u.shape[0]
    of_a, of_b, of_alpha = 0.0, 0.0, 0.0
    for i in range(n):
        ip, im = i + 1 if i < n - 1 else 0, i - 1 if i > 0 else n - 1
        for j in range(n):
            jp, jm = j + 1 if j < n - 1 else 0, j - 1 if j > 0 else n - 1
            first, second, s, r = u[i, j, 0], u[i, j, 1], du_bar[i, j, 0], du_bar[i, j, 1]
            spread = du_bar[im, j, 0] + du_bar[ip, j, 0] + du_bar[i, jp, 0] + du_bar[i, jm, 0] - 4.0 * s
            other = du_bar[im, j, 1] + du_bar[ip, j, 1] + du_bar[i, jp, 1] + du_bar[i, jm, 1] - 4.0 * r
            u_bar[i, j, 0] += alpha * spread + 2.0 * first * second * (s - r) - (a + 1.0) * s + a * r
            u_bar[i, j, 1] += alpha * other + first * first * (s - r)
            of_a += first * (r - s)
            of_b += s
            of_alpha += first * spread + second * other
    p_bar[0] += of_a
    p_bar[1] += of_b
    p_bar[2] += of_alpha / dx ** 2
    p_bar[3] -= 2.0 * alpha / dx * of_alpha


def integrate(u, u_bar, p, p_bar, dt, steps, seed):
    kept = np.empty((steps, *u.shape))
    du = np.empty_like(u)
    for s in range(steps):
        kept[s] = u
        forward_rates(du, u, p, s * dt)
        u += dt * du
    u_bar += seed * u
    for s in range(steps - 1, -1, -1):
        du[:] = dt * u_bar
        brusselator(du, du, kept[s], u_bar, p, p_bar, s * dt)


def averaged_back(a_bar, b_bar, g):
    n = a_bar.shape[0]
    for i in range(1, n - 1):
        for j in range(1, n - 1):
            g[i, j] = 0.2 * a_bar[i, j]
            a_bar[i, j] = 0.0
    for i in range(1, n - 1):
        for j in range(1, n - 1):
            b_bar[i, j] += g[i, j] + g[i, j - 1] + g[i, j + 1] + g[i + 1, j] + g[i - 1, j]
    for k in range(1, n - 1):
        b_bar[0, k] += g[1, k]
        b_bar[n - 1, k] += g[n - 2, k]
        b_bar[k, 0] += g[k, 1]
        b_bar[k, n - 1] += g[k, n - 2]


def jacobi(a, a_bar, b, b_bar, steps):
    g = np.zeros_like(a)
    for _ in range(steps):
        averaged_back(a_bar, b_bar, g)
        averaged_back(b_bar, a_bar, g)


def seidel(a, a_bar, steps, seed):
    n = a.shape[0]
    for _ in range(steps):
        for i in range(1, n - 1):
            for j in range(1, n - 1):
                a[i, j] = (a[i - 1, j - 1] + a[i - 1, j] + a[i - 1, j + 1] + a[i, j - 1] + a[i, j]
                           + a[i, j + 1] + a[i + 1, j - 1] + a[i + 1, j] + a[i + 1, j + 1]) / 9.0
    a_bar += seed * a
    for _ in range(steps):
        for i in range(n - 2, 0, -1):
            for j in range(n - 2, 0, -1):
                w = a_bar[i, j] / 9.0
                a_bar[i - 1, j - 1] += w
                a_bar[i - 1, j] += w
                a_bar[i - 1, j + 1] += w
                a_bar[i, j - 1] += w
                a_bar[i, j] = w
                a_bar[i, j + 1] += w
                a_bar[i + 1, j - 1] += w
                a_bar[i + 1, j] += w
                a_bar[i + 1, j + 1] += w


def advect(u, u_bar, c, steps):
    n, factor, c_bar = u.size, 0.5 * (1.0 - c), 0.0
    kept, apart, apart_bar = np.empty((steps, n)), np.empty(n + 1), np.empty(n + 1)
    for s in range(steps):
        kept[s] = u
        differences(u, apart)
        before = c * (u[n - 1] + factor * minmod(apart[n - 1], apart[0]))
        for i in range(n):
            flux = c * (u[i] + factor * minmod(apart[i], apart[i + 1]))
            u[i] -= flux - before
            before = flux
    for s in range(steps - 1, -1, -1):
        u[:] = kept[s]
        differences(u, apart)
        apart_bar[:] = 0.0
        first = u_bar[0]
        for i in range(n):
            flux_bar = (u_bar[i + 1] if i < n - 1 else first) - u_bar[i]
            limited = minmod(apart[i], apart[i + 1])
            c_bar += flux_bar * (u[i] + (factor - 0.5 * c) * limited)
            u_bar[i] += c * flux_bar
            if limited != 0.0:
                apart_bar[i if abs(apart[i]) < abs(apart[i + 1]) else i + 1] += c * factor * flux_bar
        apart_bar[0] += apart_bar[n]
        u_bar[n - 1] -= apart_bar[0]
        for i in range(n):
            u_bar[i] += apart_bar[i] - (apart_bar[i + 1] if i < n - 1 else 0.0)
    return c_bar


def differences(u, apart):
    apart[0] = u[0] - u[-1]
    for i in range(1, u.size):
        apart[i] = u[i] - u[i - 1]
    apart[u.size] = apart[0]


def minmod(a, b):
    if a * b <= 0.0:
        return 0.0
    return a if abs(a) < abs(b) else b


def mixture(alphas, alphas_bar, means, means_bar, scales, scales_bar, x, seed):
    n, d = x.shape
    k = alphas.size
    width, term, z, start = np.exp(scales), np.empty(k), np.empty((k, d)), np.empty(k)
    for c in range(k):
        start[c] = alphas[c] + np.sum(scales[c])
    for i in range(n):
        for c in range(k):
            term[c] = start[c]
            for j in range(d):
                z[c, j] = width[c, j] * (x[i, j] - means[c, j])
                term[c] -= 0.5 * z[c, j] * z[c, j]
        softmax(term)
        for c in range(k):
            share = seed * term[c]
            alphas_bar[c] += share
            for j in range(d):
                scales_bar[c, j] += share * (1.0 - z[c, j] * z[c, j])
                means_bar[c, j] += share * width[c, j] * z[c, j]
    term[:] = alphas
    softmax(term)
    alphas_bar -= n * seed * term


def softmax(values):
    top = np.max(values)
    total = 0.0
    for c in range(values.size):
        values[c] = np.exp(values[c] - top)
        total += values[c]
    values /= total


def nbody(position, position_bar, velocity, velocity_bar, acceleration, mass, mass_bar, dt, steps, softening, seed):
    n, kept = mass.size, np.empty((steps, *position.shape))
    for s in range(steps):
        kept[s] = position
        acceleration[:] = 0.0
        for i in range(n):
            for j in range(i + 1, n):
                x, y, z = position[j] - position[i]
                inverse = (x * x + y * y + z * z + softening * softening) ** -1.5
                for d, along in enumerate((x, y, z)):
                    acceleration[i, d] += mass[j] * along * inverse
                    acceleration[j, d] -= mass[i] * along * inverse
        velocity += dt * acceleration
        position += dt * velocity
    for i in range(n):
        mass_bar[i] += 0.5 * seed * np.sum(velocity[i] ** 2)
        velocity_bar[i] += seed * mass[i] * velocity[i]
    for s in range(steps - 1, -1, -1):
        velocity_bar += dt * position_bar
        attracted_back(kept[s], position_bar, mass, mass_bar, dt, velocity_bar, softening)


def attracted_back(position, position_bar, mass, mass_bar, dt, velocity_bar, softening):
    for i in range(mass.size):
        for j in range(i + 1, mass.size):
            x, y, z = (position[j, 0] - position[i, 0], position[j, 1] - position[i, 1],
                       position[j, 2] - position[i, 2])
            square = x * x + y * y + z * z + softening * softening
            inverse = square ** -1.5
            s, t, w = dt * velocity_bar[i, 0], dt * velocity_bar[i, 1], dt * velocity_bar[i, 2]
            q, r, o = dt * velocity_bar[j, 0], dt * velocity_bar[j, 1], dt * velocity_bar[j, 2]
            mass_bar[j] += inverse * (x * s + y * t + z * w)
            mass_bar[i] -= inverse * (x * q + y * r + z * o)
            s, t, w = mass[j] * s - mass[i] * q, mass[j] * t - mass[i] * r, mass[j] * w - mass[i] * o
            pull = -3.0 * inverse / square * (x * s + y * t + z * w)
            for d, change in enumerate((inverse * s + pull * x, inverse * t + pull * y, inverse * w + pull * z)):
                position_bar[j, d] += change
                position_bar[i, d] -= change


KERNELS: dict[str, Any] = {**{f.__name__: f for f in (brusselator, integrate, jacobi, seidel, advect, mixture, nbody)},
                           **by_hand_arrays.KERNELS, **by_hand_adbench.KERNELS}
