"""Comparisons of arrays with numbers that are spelled out."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def masks(x):
    m = x > [0.5, 0.5, 0.9]
    low = (0.5, 0.2, x[0, 0])
    return np.sum(x[m] ** 2) + np.sum(np.where(x > low, x, x ** 3))


def both_sides(x):
    some = (x > [0.5, 0.2, 0.9]) & (x != (0.15, 0.25, 0.3))
    return np.sum(np.where([0.5, 0.2, 0.97] <= x, x, x ** 2)) + np.sum(x[some] ** 3)


def rows(x):
    s = np.sum((x > [[0.5, 0.2, 0.9], [0.1, x[0, 0], 0.25]]) * x ** 2)
    if np.any(x[0] > [0.5, 0.2, 0.9]):
        s += np.sum(x ** 2 * (np.isfinite(x[0]) == [True, False, True]))
    return s


def shapes(x):
    if x.shape == (2, 3) and x.shape >= (2, 2) and len(x) in [1, 2]:
        return np.sum(x ** 2)
    return np.sum(x)


def of_integers(x, y):
    return np.sum(x[:, y == [1, 2, 3]] ** 2)


def a_number(x):
    return np.sum(np.where(x[0] > [0.5, 0.05, 0.9], x, x ** 2))


def cases():
    # an array is compared with a list
    for kernel in [masks, both_sides, rows, shapes]:
        x = np.array([[0.1, 0.7, 0.95], [0.6, 0.35, 0.22]])
        yield Case(kernel, (x,), ("x",))
    # integers are compared too
    x = np.array([[0.1, 0.7, 0.95], [0.6, 0.35, 0.22]])
    yield Case(of_integers, (x, np.array([1, 5, 3])), ("x",))
    # a number is not
    yield Case(a_number, (np.array([0.1, 0.7, 0.95]),), refused=(
        "S201 at `x[0] > [0.5, 0.05, 0.9]`: a number is compared with a list or tuple that is spelled out: make it "
        "an array: np.array([...])"))
