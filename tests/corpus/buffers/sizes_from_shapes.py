"""Written slices of shapes are sizes: what is allocated with them has a rank, and loops have ends."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def of_a_row(u):
    w = np.zeros(u.shape[1:])
    for i in range(u.shape[0]):
        for j in range(w.shape[0]):
            w[j] += u[i, j] ** 2
    return np.sum(w * 2.0)


def of_columns(u):
    w = np.zeros(u.shape[:1])
    w += u[:, 0]
    v = np.empty(u.shape[:-1])
    v[:] = w * 2
    return np.sum(w ** 2 * v)


def turned(u):
    w = np.zeros(u.shape[::-1])
    w += u.T
    w[1:] *= w[:-1]
    return np.sum(w ** 2)


def beside_others(u):
    w = np.zeros((2,) + u.shape[1:])
    w[1] += u[0]
    w[0] = np.ones(u.shape[-1:]) * w[1] ** 2
    return np.sum(w ** 2)


def cases():
    # derivatives
    for kernel in (of_a_row, of_columns, turned, beside_others):
        yield Case(kernel, (np.array([[0.3, 0.9, 0.7], [0.5, 0.2, 0.6]]),), ("u",))
