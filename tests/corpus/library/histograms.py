"""Histograms with a number of bins, whose ends are the least and the greatest number; shares in bins of any width."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def edges(x, w):
    h, e = np.histogram(x, 3)
    g, f = np.histogram(x)
    return np.sum(h * e[1:]) + np.sum(e ** 2) + np.sum(g * f[:-1] ** 2)


def shares(x, w):
    """The edges move with the numbers, and so do the shares."""
    h, e = np.histogram(x, bins=4, density=True)
    return np.sum(h ** 2) + np.sum(0.5 * (e[1:] + e[:-1]) * h)


def weighted(x, w):
    h, e = np.histogram(x, 3, weights=w, density=True)
    g, f = np.histogram(x[::-1], 2, weights=w[::-1])
    return np.sum(h ** 2 * e[1:]) + np.sum(g ** 2 * f[:-1])


def by_position(x, w):
    """Behind the range stands whether it is a density."""
    h, e = np.histogram(x, 3, (0.0, 2.0), False, w)
    g, _ = np.histogram(x, 3, (0.0, 2.0), True)
    p, q = np.histogram(x, np.array([0.0, 0.8 * w[0], 2.0]), density=True)
    return np.sum(h ** 2 * e[1:]) + np.sum(g) * x[0] + np.sum(p ** 2 * q[1:])


def of_few(x, w):
    h, e = np.histogram(x[:1], 2)
    g, f = np.histogram(x[:0], 3)
    return np.sum(h * e[1:] ** 2) + np.sum(g) * x[0] + np.sum(f) * x[1]


def of_integers(x, w):
    h, e = np.histogram(np.array([3, 1, 4, 1, 5]), 2)
    return np.sum(h * e[1:]) * x[0]


def written_behind(x, w):
    h, e = np.histogram(x, 2)
    x[0] = w[1] ** 2
    e[0] = x[0]
    return np.sum(h * e[1:] ** 2) + np.sum(x ** 2) + e[0]


def cases():
    x, w = np.array([0.3, 0.9, 1.4, 0.7]), np.array([0.4, 1.2, 0.8, 2.0])
    for kernel in (edges, shares, weighted, by_position, of_few, of_integers, written_behind):
        yield Case(kernel, (x, w), ("x", "w"))
