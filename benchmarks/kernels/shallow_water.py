"""2-D rotating shallow water, forward-backward in time, in place; periodic in both directions."""
from dataclasses import dataclass
import numpy as np


@dataclass
class Params:
    g: float = 9.81
    depth: float = 100.0
    f: float = 1e-4
    drag: float = 1e-5
    nu: float = 50.0
    dx: float = 1000.0
    dy: float = 1000.0
    dt: float = 10.0


def wrap(i, n):
    if i < 0:
        return i + n
    if i >= n:
        return i - n
    return i


def laplacian(a, i, j, dx, dy):
    n, m = a.shape
    ip, im, jp, jm = wrap(i + 1, n), wrap(i - 1, n), wrap(j + 1, m), wrap(j - 1, m)
    return ((a[ip, j] - 2.0 * a[i, j] + a[im, j]) / dx ** 2
            + (a[i, jp] - 2.0 * a[i, j] + a[i, jm]) / dy ** 2)


def momentum(u, v, h, un, vn, p: Params):
    n, m = u.shape
    for i in range(n):
        for j in range(m):
            ip, im, jp, jm = wrap(i + 1, n), wrap(i - 1, n), wrap(j + 1, m), wrap(j - 1, m)
            speed = np.sqrt(u[i, j] ** 2 + v[i, j] ** 2 + 1e-12)
            ux = (u[ip, j] - u[im, j]) / (2.0 * p.dx)
            uy = (u[i, jp] - u[i, jm]) / (2.0 * p.dy)
            vx = (v[ip, j] - v[im, j]) / (2.0 * p.dx)
            vy = (v[i, jp] - v[i, jm]) / (2.0 * p.dy)
            hx = (h[ip, j] - h[im, j]) / (2.0 * p.dx)
            hy = (h[i, jp] - h[i, jm]) / (2.0 * p.dy)
            un[i, j] = u[i, j] + p.dt * (-u[i, j] * ux - v[i, j] * uy + p.f * v[i, j] - p.g * hx
                                         - p.drag * speed * u[i, j] + p.nu * laplacian(u, i, j, p.dx, p.dy))
            vn[i, j] = v[i, j] + p.dt * (-u[i, j] * vx - v[i, j] * vy - p.f * u[i, j] - p.g * hy
                                         - p.drag * speed * v[i, j] + p.nu * laplacian(v, i, j, p.dx, p.dy))


def continuity(h, u, v, hn, p: Params):
    n, m = h.shape
    for i in range(n):
        for j in range(m):
            ip, im, jp, jm = wrap(i + 1, n), wrap(i - 1, n), wrap(j + 1, m), wrap(j - 1, m)
            fx = ((p.depth + h[ip, j]) * u[ip, j] - (p.depth + h[im, j]) * u[im, j]) / (2.0 * p.dx)
            fy = ((p.depth + h[i, jp]) * v[i, jp] - (p.depth + h[i, jm]) * v[i, jm]) / (2.0 * p.dy)
            hn[i, j] = h[i, j] - p.dt * (fx + fy)


def step(u, v, h, un, vn, hn, p: Params):
    momentum(u, v, h, un, vn, p)
    continuity(h, un, vn, hn, p)
    for i in range(u.shape[0]):
        for j in range(u.shape[1]):
            u[i, j] = un[i, j]
            v[i, j] = vn[i, j]
            h[i, j] = hn[i, j]


def run(u, v, h, p: Params, steps):
    un, vn, hn = np.empty_like(u), np.empty_like(v), np.empty_like(h)
    for _ in range(steps):
        step(u, v, h, un, vn, hn, p)


def misfit(h0, p: Params, observed, steps):
    h = h0.copy()
    u, v = np.zeros_like(h), np.zeros_like(h)
    run(u, v, h, p, steps)
    total = 0.0
    for i in range(h.shape[0]):
        for j in range(h.shape[1]):
            total += (h[i, j] - observed[i, j]) ** 2
    return total / h.size
