"""Axes of length 1 that names and results of functions have: what they are combined with repeats them."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])
P = np.array([[0.4, 0.9, 0.3], [1.2, 0.5, 0.8], [0.6, 1.4, 0.7], [0.2, 1.1, 1.3]])


def energy(p, mass):
    return 0.5 * np.sum(mass * p ** 2)


def separation(p):
    column = p[:, 0:1]
    return column.T - column


def by_a_helper(x, p):
    """A column that was computed, handed on in a loop and outside of it."""
    mass = 2.0 * np.ones((len(x), 1)) / len(x)
    total = energy(p, mass)
    for _ in range(2):
        p = p + 0.1 * mass
        mass = mass * x[0]
        total = total + energy(p, mass)
    return total


def layer(params, a):
    return np.tanh(params["W"] @ a + params["b"])


def network(x, p):
    params = {"W": np.outer(x, x)}
    params["b"] = np.zeros((len(x), 1))
    params["b"] += x.reshape(-1, 1)
    for _ in range(3):
        p = layer(params, p)
    return np.sum(p ** 2)


def made_by_helpers(x, p):
    d = separation(p)
    weights = np.sqrt(np.sum(p ** 2, axis=1, keepdims=True) + 0.1)
    inverse = 1.0 / weights
    return np.sum(d * weights) + np.sum(np.where(d > 0.0, inverse, inverse.T) * d) + energy(p, inverse)


def of_two_widths(x, p):
    """Columns on one way and whole rows on the other: nothing is known of the name."""
    q = x[:, None] * 2.0
    if x[0] > 0.1:
        q = p * x[:, None]
    r = q * p
    return np.sum(r ** 2) + energy(r, q)


def wider_from_step_to_step(x, p):
    q = x.reshape(4, 1)
    for _ in range(2):
        q = np.concatenate((q, q * 0.5), axis=1)
    return np.sum(q ** 2) + energy(q, q * 2.0)


def of_both_kinds(x, p):
    """One helper for a column and for a matrix."""
    column = np.exp(x).reshape((4, 1))
    return energy(p, column) + energy(p, p) + energy(column, column)


def kept_in_an_expression(x, p):
    row = np.zeros((1, 3))
    row[0, :] = x[:3]
    scaled = -np.minimum(row, 1.0)
    return np.sum((scaled - p) ** 2) + energy(p, np.exp(scaled) + row)


def cases():
    for kernel in (by_a_helper, network, made_by_helpers, of_two_widths, wider_from_step_to_step, of_both_kinds,
                   kept_in_an_expression):
        yield Case(kernel, (X, P), ("x", "p"))
