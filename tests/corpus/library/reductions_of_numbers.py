"""Reductions of a number: NumPy takes it for an array without axes."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 1.1, -0.7])


def twice(x):
    return np.sum(np.sum(x * x)) + np.max(np.max(x)) * np.amin(np.min(x, axis=0), axis=0)


def methods(x):
    s = x[0] * x[1]
    return x.var(axis=0).sum() + s.mean() * s.max() - s.min() * s.prod()


def averages(x):
    s = x[0] * x[2]
    return np.mean(s, axis=None) * np.median(s) * np.average(x[1]) + np.prod(s, keepdims=False)


def sizes(x):
    s = x[0] * x[2]
    return np.linalg.norm(s) + np.abs(np.linalg.norm(np.sum(x))) * np.linalg.norm(x[1])


def spreads(x):
    s = x[0] * x[1]
    return np.std(s) * x[0] + np.var(s, ddof=0) + np.exp(s.std()) * s


def integers(x):
    n = x.size
    return np.mean(n) * x[0] + np.sum(n) * x[1] + np.max(n // 2) * x[2]


def in_a_loop(x):
    s = 0.0
    for i in range(x.size):
        s += np.sum(x[i] ** 2) * np.linalg.norm(s - x[i])
    return s


def counted(x):
    return np.sum(x[0] > 0) * x[1]


def spread_of_a_sample(x):
    return np.std(x[0], ddof=1)


def cases():
    # reductions of numbers
    for kernel in (twice, methods, averages, sizes, spreads, integers, in_a_loop):
        yield Case(kernel, (X,), ("x",))
    # single precision stays
    yield Case(sizes, (X.astype("float32"),), ("x",))
    yield Case(averages, (X[[0, 1, 2]].astype("float32"),), ("x",))
    # what is refused
    for kernel, refused in (
            (counted,
             "S301 at `np.sum(x[0] > 0)`: no derivative rule for numpy.sum of bool: write a loop that adds the "
             "elements"),
            (spread_of_a_sample,
             "S301 at `np.std(x[0], ddof=1)`: no derivative rule for numpy.std: write it with functions that "
             "have a rule, or give it one: s2sad.rule, s2sad.nondifferentiable")):
        yield Case(kernel, (X,), refused=refused)
