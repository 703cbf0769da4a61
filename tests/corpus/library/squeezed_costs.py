"""`np.squeeze` without an axis, of what a product of rows leaves, under the same name or another."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def same_name(x, y):
    a = x.reshape(1, 3) ** 2
    m = y.shape[1]
    cost = (1.0 / m) * (-np.dot(y, np.log(a).T) - np.dot(1 - y, np.log(1 - a).T))
    cost = np.squeeze(cost)
    assert cost.shape == ()
    return cost


def with_an_argument(x, y):
    rows = np.dot(y, np.log(x.reshape(1, 3)).T)
    return np.squeeze(rows)


def cross_entropy(a, y):
    cost = -np.dot(y, np.log(a).T) / y.shape[1]
    cost = np.squeeze(cost)
    cost += 0.5
    return cost


def of_a_function(x, y):
    a = x.reshape(1, 3) ** 2 * 0.2
    k = cross_entropy(a, y)
    k += np.sum(x * x)
    x[0] = 3.0
    return k * x[1]


def cases():
    x, y = np.array([0.5, 0.2, 0.7]), np.array([[1.0, 0.0, 1.0]])
    for kernel in [same_name, with_an_argument, of_a_function]:
        yield Case(kernel, (x, y), ("x", "y"))
