"""Parts of arrays in lists (`np.split`), rows of arrays as arguments one by one (`f(*q)`), frames of one number."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9, 0.5])


def in_a_loop(x):
    parts = np.split(x[:4], 2)
    total = parts[1][0]
    for p in parts:
        total += np.sum(p ** 2) * p[0]
    return total + sum(np.sum(p) ** 2 for p in np.array_split(x, 3)) + np.hsplit(x, 5)[2][0]


def heads(x):
    y = np.outer(x, x[:4])
    halves = np.split(y, 2, axis=-1)
    parts = [np.split(a, 2, axis=-1) for a in halves]
    mask = (1 - np.tri(y.shape[0], dtype=y.dtype)) * -1e10
    total = np.zeros((5, 5))
    for q, k in zip(*parts):
        e = np.exp(q @ k.T + mask)
        total += e / e.sum(axis=-1, keepdims=True)
    return np.sum(total ** 2) + np.sum(np.hstack([q * k for q, k in zip(*parts)]))


def flux(h, hu):
    return hu ** 2 / h + 0.5 * h[::-1] ** 2


class Speed:
    def __init__(self, g):
        self.g = g

    def at(self, h, hu):
        return hu / h + np.sqrt(self.g * h)


def one_by_one(x):
    q, speed = np.stack([x, 2.0 * x[::-1]]), Speed(9.81)
    for _ in range(2):
        shifted = np.roll(q, -1, axis=1)
        q = q - 0.1 * (flux(*q) - flux(*shifted)) / speed.at(*q)
    return np.sum(flux(x, *q[:1]) * q[1])


def framed(x):
    y = np.pad(np.outer(x, x), ((1, 1), (0, 2)), "constant", constant_values=(0, 0))
    z = np.pad(x, (2, 1), "constant", constant_values=((1.5, 1.5),))
    return np.sum(y[:, 1:] * y[:, :-1]) + np.sum(z[1:] * z[:-1])


def counted_sections(y, count):
    parts = [np.split(a, count, axis=-1) for a in np.split(y, 2, axis=-1)]
    return sum(np.sum(q ** 2 * k) for q, k in zip(*parts))


class Quaternion:
    def __init__(self, w, x, y, z):
        self.w, self.x, self.y, self.z = w, x, y, z


@dataclass
class Point:
    x: float
    y: float


def made_of_rows(y):
    steps = np.diff(y, axis=0)
    q, p = Quaternion(y[0, 0], *np.diff(y[1])), Point(*np.diff(y[0, :3]))
    return np.sum(np.hypot(*steps[:, :2].T)) + q.w * q.x + q.y * q.z + p.x / p.y


def cases():
    for kernel in (in_a_loop, heads, one_by_one, framed):
        yield Case(kernel, (X,), "x")
    y = np.outer(X, X[:4] ** 2) + X[:, None]
    yield Case(counted_sections, (y, 2), "y")
    yield Case(made_of_rows, (y,), "y")
