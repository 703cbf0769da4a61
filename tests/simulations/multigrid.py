"""Poisson's equation with a variable coefficient by multigrid V-cycles on grids that halve."""
import numpy as np


def smooth(u, f, k, h, sweeps):
    """Red-black Gauss-Seidel in place."""
    n = u.size
    for _ in range(sweeps):
        for colour in range(2):
            for i in range(1 + colour, n - 1, 2):
                west = 0.5 * (k[i] + k[i - 1])
                east = 0.5 * (k[i] + k[i + 1])
                u[i] = (west * u[i - 1] + east * u[i + 1] + h * h * f[i]) / (west + east)


def residual(u, f, k, h):
    r = np.zeros_like(u)
    west = 0.5 * (k[1:-1] + k[:-2])
    east = 0.5 * (k[1:-1] + k[2:])
    r[1:-1] = f[1:-1] - (west * (u[1:-1] - u[:-2]) + east * (u[1:-1] - u[2:])) / h ** 2
    return r


def restrict(fine):
    coarse = fine[::2].copy()
    coarse[1:-1] = 0.25 * (fine[1:-2:2] + fine[3::2]) + 0.5 * fine[2:-1:2]
    return coarse


def two_grids(u, f, k, h):
    """One cycle: the coarse grid is smoothed until it is solved."""
    smooth(u, f, k, h, 2)
    r = restrict(residual(u, f, k, h))
    e = np.zeros_like(r)
    smooth(e, r, k[::2].copy(), 2.0 * h, 8)
    u[::2] += e
    u[1::2] += 0.5 * (e[1:] + e[:-1])
    smooth(u, f, k, h, 2)


def multigrid(u, f, k, cycles):
    """The solution in place; returns its compliance."""
    h = 1.0 / (u.size - 1)
    for _ in range(cycles):
        two_grids(u, f, k, h)
    return h * np.dot(f, u)
