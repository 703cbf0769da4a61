"""Adjoints that read what their statement left, in loops that store there since: it is put back."""
from __future__ import annotations

import numpy as np

import s2sad
from tests.corpus import Case

U, M = np.array([0.3, 0.9]), np.array([[2.0, 0.6], [0.6, 1.5]])


def emptied(u, m):
    w = np.zeros(2)
    for _ in range(2):
        w[:] = np.linalg.solve(m, u)
        u += w
        w[:] = 0.0
    return np.sum(u)


def a_given_value(u, m):
    for _ in range(2):
        w = np.linalg.solve(m, u)
        w[0] = 0.0
        u += w
    return np.sum(u)


def of_a_factor(u, m):
    for _ in range(2):
        factor = np.linalg.cholesky(m)
        u += factor[1]
        factor[0] = 1.0
        m += np.eye(2) * u[0]
    return np.sum(u)


def made_anew(u, m):
    w = np.zeros(2)
    for _ in range(2):
        w[:] = np.linalg.solve(m, u)
        u = u + w
        w = np.zeros(2)
    return np.sum(u * u)


def line(r, x, k, b):
    r[:] = k * x - b


@s2sad.rule(implicit=line)
def solved(x, k, b):
    x[:] = b / k


def implicit(u, m):
    for _ in range(2):
        x = np.zeros(2)
        solved(x, m[0], u)
        u += x
    return np.sum(u)


def implicit_and_changed(u, m):
    x, total = np.zeros(2), 0.0
    for t in range(3):
        x[:] = 0.0
        solved(x, m[0], u)
        total += x[0]
        if t > 0:
            x[0] = 2.0 * x[1]
        u += x
    return np.sum(u) * total


def cases():
    # results read again
    for kernel in (emptied, a_given_value, of_a_factor, made_anew, implicit, implicit_and_changed):
        yield Case(kernel, (U, M), ("u", "m"))
