"""What an outer loop does not change is computed before it, and only that."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([[0.3, -0.9, 0.7, 0.2], [0.5, 0.1, -0.4, 0.8], [-0.2, 0.6, 0.4, -0.7]])


def tables(x, w):
    """Two functions of one array, backwards and from the second, of a name that is bound to it."""
    total = 0.0
    for i in range(x.shape[0]):
        for j in range(w.size - 1, -1, -1):
            v = w[j] * 0.5
            total += np.exp(v) * x[i, j] ** 2
        for j in range(1, w.size):
            total += np.sin(w[j - 1]) * x[i, j] ** 3
    return total


def of_two_counters(x, w):
    """A table of two axes, which a loop between does not vary with."""
    for s in range(3):
        for i in range(x.shape[0]):
            for t in range(2):
                for j in range(w.size):
                    w[j] += np.exp(-0.1 * x[i, j]) * (w[j] * s + t)


def once_a_step(x, w):
    """The operand moves from step to step, and is the same for all rows."""
    for _ in range(3):
        for i in range(x.shape[0]):
            for j in range(w.size):
                x[i, j] = x[i, j] * np.exp(w[j]) - 0.1 * x[i, j] ** 2
        for j in range(w.size):
            w[j] = w[j] * 0.7 + 0.1 * x[0, j]


def written(x, w):
    """The outer loop writes the operand behind the inner one."""
    for i in range(x.shape[0]):
        for j in range(w.size):
            x[i, j] = x[i, j] ** 2 * np.exp(w[j])
        w[0] += x[i, 1]


def _change(w, by):
    w[1] -= by


def written_by_a_function(x, w):
    for i in range(x.shape[0]):
        for j in range(w.size):
            x[i, j] = x[i, j] ** 2 * np.exp(w[j])
        _change(w, x[i, 0])


def moving_name(x, w):
    """A number in the argument is bound anew by the outer loop."""
    s = 0.3
    for i in range(x.shape[0]):
        for j in range(w.size):
            x[i, j] = x[i, j] ** 2 * np.exp(w[j] * s)
        s = s * 1.5 + x[i, 0]


def carried_name(x, w):
    """A name that is bound behind its use: an iteration reads what the last one left."""
    v = 0.2
    for i in range(x.shape[0]):
        for j in range(w.size):
            x[i, j] = x[i, j] ** 2 * np.exp(v + 0.1 * w[j])
            v = w[j]


def in_a_branch(x, w):
    """Computed for some rows only: the others' may lie outside of the array."""
    for i in range(x.shape[0]):
        if x[i, 0] > 0.4:
            for j in range(w.size):
                x[i, j] = x[i, j] ** 2 * np.exp(w[j])


def left_early(x, w):
    """The loop is left before the operand's end is read."""
    for i in range(x.shape[0]):
        for j in range(w.size):
            if x[i, j] < 0.0:
                break
            x[i, j] = x[i, j] ** 2 * np.exp(w[j])


def triangle(x, w):
    for i in range(x.shape[0]):
        for j in range(i):
            x[i, j] = x[i, j] ** 2 * np.exp(w[j])


def of_pairs(x, w):
    """As many values as pairs: a table would be larger than the arrays that it is made from."""
    for _ in range(2):
        for i in range(x.shape[0]):
            for j in range(w.size):
                x[i, j] = x[i, j] ** 2 * np.exp(w[i] * w[j])


def cases():
    w = np.array([0.4, -0.3, 0.6, 0.9])
    yield Case(tables, (X, w), ("x", "w"))
    yield Case(of_two_counters, (X, w), ("x", "w"), ("w",))
    for kernel in (once_a_step, written, written_by_a_function, moving_name, carried_name, in_a_branch, left_early,
                   triangle, of_pairs):
        yield Case(kernel, (X, w), ("x", "w"), ("x",))
