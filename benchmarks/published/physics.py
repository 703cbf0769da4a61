"""Particles and flows as their textbooks have them in NumPy: molecular dynamics, a particle pusher, Riemann solvers,
the Navier-Stokes equations in twelve steps (L. Barba, G. Forsyth, 2018; also in NPBench)."""
from __future__ import annotations

import numpy as np


def lennard_jones(position, box):
    """The energy of a periodic fluid, cut off at 2.5."""
    energy = 0.0
    for i in range(position.shape[0]):
        for j in range(i + 1, position.shape[0]):
            r2 = 0.0
            for k in range(3):
                d = position[i, k] - position[j, k]
                d -= box * np.round(d / box)
                r2 += d * d
            if r2 < 6.25:
                s6 = 1.0 / (r2 * r2 * r2)
                energy += 4.0 * (s6 * s6 - s6)
    return energy


def lj_forces(position, force, box):
    """The forces of the same fluid."""
    n = position.shape[0]
    for i in range(n):
        for j in range(i + 1, n):
            d = position[i] - position[j]
            d = d - box * np.round(d / box)
            r2 = np.sum(d * d)
            if r2 < 6.25:
                s6 = 1.0 / r2 ** 3
                f = 48.0 * s6 * (s6 - 0.5) / r2 * d
                force[i] += f
                force[j] -= f


def boris(x, v, E, B, q, dt, steps):
    """Charged particles in a uniform field (J. Boris, 1970)."""
    for _ in range(steps):
        for p in range(x.shape[0]):
            t = 0.5 * q[p] * dt * B
            s = 2.0 * t / (1.0 + np.dot(t, t))
            minus = v[p] + 0.5 * q[p] * dt * E
            prime = minus + np.cross(minus, t)
            plus = minus + np.cross(prime, s)
            v[p] = plus + 0.5 * q[p] * dt * E
            x[p] = x[p] + dt * v[p]


def two_body_pairs(pos, mass, acc, G, softening):
    """Accelerations of all by all, as arrays (P. Mocz, 2020)."""
    x, y, z = pos[:, 0:1], pos[:, 1:2], pos[:, 2:3]
    dx, dy, dz = x.T - x, y.T - y, z.T - z
    inv_r3 = (dx ** 2 + dy ** 2 + dz ** 2 + softening ** 2) ** (-1.5)
    acc[:, 0:1] = G * (dx * inv_r3) @ mass
    acc[:, 1:2] = G * (dy * inv_r3) @ mass
    acc[:, 2:3] = G * (dz * inv_r3) @ mass


def euler_flux(rho, m, E):
    u = m / rho
    p = 0.4 * (E - 0.5 * rho * u * u)
    return m, m * u + p, u * (E + p), u, np.sqrt(1.4 * p / rho)


def hll(rho, m, E, ratio, steps):
    """Gas in a tube by the solver of Harten, Lax and van Leer (1983)."""
    n = rho.shape[0]
    f = np.zeros((n - 1, 3))
    for _ in range(steps):
        for i in range(n - 1):
            l0, l1, l2, ul, cl = euler_flux(rho[i], m[i], E[i])
            r0, r1, r2, ur, cr = euler_flux(rho[i + 1], m[i + 1], E[i + 1])
            sl, sr = min(ul - cl, ur - cr), max(ul + cl, ur + cr)
            if sl >= 0.0:
                f[i, 0], f[i, 1], f[i, 2] = l0, l1, l2
            elif sr <= 0.0:
                f[i, 0], f[i, 1], f[i, 2] = r0, r1, r2
            else:
                f[i, 0] = (sr * l0 - sl * r0 + sl * sr * (rho[i + 1] - rho[i])) / (sr - sl)
                f[i, 1] = (sr * l1 - sl * r1 + sl * sr * (m[i + 1] - m[i])) / (sr - sl)
                f[i, 2] = (sr * l2 - sl * r2 + sl * sr * (E[i + 1] - E[i])) / (sr - sl)
        rho[1:-1] -= ratio * (f[1:, 0] - f[:-1, 0])
        m[1:-1] -= ratio * (f[1:, 1] - f[:-1, 1])
        E[1:-1] -= ratio * (f[1:, 2] - f[:-1, 2])


def roe(q, ratio, steps):
    """The same gas by Roe's linearization (1981), whole arrays."""
    for _ in range(steps):
        rho, u = q[0], q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * rho * u ** 2)
        H = (q[2] + p) / rho
        flux = np.stack((q[1], q[1] * u + p, u * (q[2] + p)))
        w = np.sqrt(rho)
        ua = (w[:-1] * u[:-1] + w[1:] * u[1:]) / (w[:-1] + w[1:])
        ha = (w[:-1] * H[:-1] + w[1:] * H[1:]) / (w[:-1] + w[1:])
        a = np.sqrt(0.4 * (ha - 0.5 * ua ** 2))
        d = q[:, 1:] - q[:, :-1]
        a2 = 0.4 / a ** 2 * ((ha - ua ** 2) * d[0] + ua * d[1] - d[2])
        a1 = 0.5 / a * ((ua + a) * d[0] - d[1] - a * a2)
        a3 = d[0] - a1 - a2
        l1, l2, l3 = np.abs(ua - a) * a1, np.abs(ua) * a2, np.abs(ua + a) * a3
        jump = np.stack((l1 + l2 + l3, (ua - a) * l1 + ua * l2 + (ua + a) * l3,
                         (ha - ua * a) * l1 + 0.5 * ua ** 2 * l2 + (ha + ua * a) * l3))
        between = 0.5 * (flux[:, :-1] + flux[:, 1:] - jump)
        q[:, 1:-1] -= ratio * (between[:, 1:] - between[:, :-1])


def build_up_b(b, rho, dt, u, v, dx, dy):
    b[1:-1, 1:-1] = rho * (
        1 / dt * ((u[1:-1, 2:] - u[1:-1, 0:-2]) / (2 * dx) + (v[2:, 1:-1] - v[0:-2, 1:-1]) / (2 * dy))
        - ((u[1:-1, 2:] - u[1:-1, 0:-2]) / (2 * dx)) ** 2
        - 2 * ((u[2:, 1:-1] - u[0:-2, 1:-1]) / (2 * dy) * (v[1:-1, 2:] - v[1:-1, 0:-2]) / (2 * dx))
        - ((v[2:, 1:-1] - v[0:-2, 1:-1]) / (2 * dy)) ** 2)


def pressure_poisson(nit, p, dx, dy, b):
    for _ in range(nit):
        pn = p.copy()
        p[1:-1, 1:-1] = (((pn[1:-1, 2:] + pn[1:-1, 0:-2]) * dy ** 2 + (pn[2:, 1:-1] + pn[0:-2, 1:-1]) * dx ** 2)
                         / (2 * (dx ** 2 + dy ** 2)) - dx ** 2 * dy ** 2 / (2 * (dx ** 2 + dy ** 2)) * b[1:-1, 1:-1])
        p[:, -1] = p[:, -2]
        p[0, :] = p[1, :]
        p[:, 0] = p[:, 1]
        p[-1, :] = 0


def cavity_flow(nt, nit, u, v, dt, dx, dy, p, rho, nu):
    b = np.zeros_like(u)
    for _ in range(nt):
        un = u.copy()
        vn = v.copy()
        build_up_b(b, rho, dt, u, v, dx, dy)
        pressure_poisson(nit, p, dx, dy, b)
        u[1:-1, 1:-1] = (un[1:-1, 1:-1] - un[1:-1, 1:-1] * dt / dx * (un[1:-1, 1:-1] - un[1:-1, 0:-2])
                         - vn[1:-1, 1:-1] * dt / dy * (un[1:-1, 1:-1] - un[0:-2, 1:-1])
                         - dt / (2 * rho * dx) * (p[1:-1, 2:] - p[1:-1, 0:-2])
                         + nu * (dt / dx ** 2 * (un[1:-1, 2:] - 2 * un[1:-1, 1:-1] + un[1:-1, 0:-2])
                                 + dt / dy ** 2 * (un[2:, 1:-1] - 2 * un[1:-1, 1:-1] + un[0:-2, 1:-1])))
        v[1:-1, 1:-1] = (vn[1:-1, 1:-1] - un[1:-1, 1:-1] * dt / dx * (vn[1:-1, 1:-1] - vn[1:-1, 0:-2])
                         - vn[1:-1, 1:-1] * dt / dy * (vn[1:-1, 1:-1] - vn[0:-2, 1:-1])
                         - dt / (2 * rho * dy) * (p[2:, 1:-1] - p[0:-2, 1:-1])
                         + nu * (dt / dx ** 2 * (vn[1:-1, 2:] - 2 * vn[1:-1, 1:-1] + vn[1:-1, 0:-2])
                                 + dt / dy ** 2 * (vn[2:, 1:-1] - 2 * vn[1:-1, 1:-1] + vn[0:-2, 1:-1])))
        u[0, :] = 0
        u[:, 0] = 0
        u[:, -1] = 0
        u[-1, :] = 1
        v[0, :] = 0
        v[-1, :] = 0
        v[:, 0] = 0
        v[:, -1] = 0


def channel_flow(nit, u, v, dt, dx, dy, p, rho, nu, F, tolerance):
    """Flow between two plates, periodic along them, until it hardly changes; the velocity across stays."""
    udiff, b = 1.0, np.zeros_like(u)
    while udiff > tolerance:
        un = u.copy()
        build_up_b(b, rho, dt, u, v, dx, dy)
        for _ in range(nit):
            pn = p.copy()
            p[1:-1, :] = ((np.roll(pn, -1, axis=1)[1:-1, :] + np.roll(pn, 1, axis=1)[1:-1, :]) * dy ** 2
                          + (pn[2:, :] + pn[:-2, :]) * dx ** 2 - dx ** 2 * dy ** 2 * b[1:-1, :]) \
                / (2 * (dx ** 2 + dy ** 2))
            p[-1, :] = p[-2, :]
            p[0, :] = p[1, :]
        east, west = np.roll(un, -1, axis=1), np.roll(un, 1, axis=1)
        u[1:-1, :] = (un[1:-1, :] - un[1:-1, :] * dt / dx * (un[1:-1, :] - west[1:-1, :])
                      - v[1:-1, :] * dt / dy * (un[1:-1, :] - un[:-2, :])
                      - dt / (2 * rho * dx) * (np.roll(p, -1, axis=1)[1:-1, :] - np.roll(p, 1, axis=1)[1:-1, :])
                      + nu * (dt / dx ** 2 * (east[1:-1, :] - 2 * un[1:-1, :] + west[1:-1, :])
                              + dt / dy ** 2 * (un[2:, :] - 2 * un[1:-1, :] + un[:-2, :])) + F * dt)
        u[0, :] = 0
        u[-1, :] = 0
        udiff = (np.sum(u) - np.sum(un)) / np.sum(u)
