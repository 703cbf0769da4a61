"""NumPy's grids by slices: np.mgrid and np.ogrid."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.62])


def of_ranges(x):
    n = len(x)
    i, j = np.mgrid[:n, 0:n]
    a = np.where((i - 1) ** 2 + (j - 2) ** 2 < 4, x[i], x[j] ** 2)
    p, q, r = np.mgrid[0:2, 1:3, 0:n:2]
    return np.sum(a) + np.sum(p * x[0] + q * x[1] ** 2 + x[r])


def of_counts(x):
    u, v = np.mgrid[0:1:4j, x[0]:1:4j]
    s = np.mgrid[0:1:0.25, 0:4]
    w = np.mgrid[0:1:4j, 0:4][1] / 2
    return np.sum(u * x[:, None] + v ** 2) + np.sum(s[0] * x) + np.sum(w * x)


def open_ones(x):
    u, k = np.ogrid[-1:1:4j, :4]
    i, j = np.ogrid[0:4, 1:4]
    return np.sum(u ** 2 * x + k / 3 * x ** 2) + np.sum(x[i] * x[j])


def of_one_axis(x):
    k = np.mgrid[0:4]
    return np.sum(x[k] * k) + np.sum(np.mgrid[0:1:4j] * x)


def of_one_type(x, n, m, h):
    u, v = np.mgrid[0:n, 0:1:0.25]
    p, q = np.mgrid[0:n, 0:2:h]
    r, s = np.ogrid[0:n, 0:m]
    u[0, 0] = p[0, 0] = 0.5
    z = np.full_like(p, 0.5)
    z[1] /= 3.0
    return np.sum(u * x[0] + v) + np.sum(p * x[1] + q) * np.sum(z) + np.sum(x[r] * x[s])


def of_two_counts(x):
    return np.sum(np.mgrid[0:1:2.5j] * x)


def of_an_open_slice(x):
    return np.sum(np.ogrid[0:, 0:4][1] * x)


def cases():
    for kernel in (of_ranges, of_counts, open_ones, of_one_axis):
        yield Case(kernel, (X,), ("x",))
    # all axes have one type
    yield Case(of_one_type, (X, 3, 4, 0.5), ("x",))
    for kernel, refused in (
            (of_two_counts,
             "S201 at `np.mgrid[0:1:2.5j]`: a grid by np.mgrid of other slices than one to three with ends: write "
             "np.meshgrid(x, y, indexing='ij'), of ranges that have names"),
            (of_an_open_slice,
             "S201 at `np.ogrid[0:, 0:4]`: a grid by np.ogrid of other slices than one to three with ends: write "
             "np.meshgrid(x, y, indexing='ij'), of ranges that have names")):
        yield Case(kernel, (X,), refused=refused)
