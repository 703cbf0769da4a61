"""Products of one matrix with the rows of a loop are products of blocks of rows; what they give is the same."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(11)


def layers(w, b, v, x, y):
    """Rows that are independent: every product of the reverse sweep is one of blocks."""
    for i in range(x.shape[0]):
        h = np.tanh(w @ x[i] + b)
        y[i] = h @ v


def recurrent(w, u, x, h):
    """A state that flows: the products with x are made before, the gains of u behind."""
    for t in range(x.shape[0]):
        h[:] = np.tanh(w @ x[t] + u @ h)
    return np.sum(h ** 2)


def backwards(w, x, y):
    for i in range(x.shape[0] - 1, 0, -1):
        y[i - 1] += w.T @ x[i] * 0.5 + (x[i] @ w)[0]


def in_place(w, x):
    """Every row is replaced by its product, the next one reads it."""
    for i in range(x.shape[0]):
        x[i] = np.sin(w @ x[i])
        if i + 1 < x.shape[0]:
            x[i + 1] += 0.5 * x[i]


def matrix_that_changes(w, x, y):
    for i in range(x.shape[0]):
        y[i] = w @ x[i]
        w[i % 3, 0] *= 1.0 + 0.1 * x[i, 1]


def branches(w, x):
    """What is asked of a product in both sweeps is asked of the same digits."""
    s = 0.0
    for i in range(x.shape[0]):
        h = w @ x[i]
        for j in range(h.size):
            if h[j] > 0.1:
                s += h[j] * h[j] * x[i, 0]
    return s


def early_end(w, x, y):
    for i in range(x.shape[0]):
        t = w @ x[i]
        if t[0] < -5.0:
            break
        y[i] = t * t


def outer(w, x, y):
    for i in range(x.shape[0]):
        y += np.outer(w @ x[i], x[i]) * x[i, 0]


def mixed(w, x, y):
    for i in range(1, x.shape[0]):
        y[i] = w @ x[i - 1] + x[i] @ w
        y[i - 1] *= w @ y[i]


def from_the_end(w, x, y):
    """Rows that count from the end are no part of the matrix."""
    for i in range(-2, 2):
        y[i] += w @ x[i] * x[i, 0]


def ends_that_change(w, x, y, p):
    for i in range(p[0]):
        y[i] = np.tanh(w @ x[i])
        p[0] = 1


def from_an_argument(w, x, y, k):
    for i in range(k, 3):
        y[i] += np.tanh(w @ x[i])


X, W, V, B = RNG.standard_normal((5, 3)), RNG.standard_normal((3, 3)), RNG.standard_normal((3, 2)), RNG.random(3)
LONG = RNG.standard_normal((131, 3))
CASES = [
    (layers, (W, B, V, X, np.zeros((5, 2))), ("w", "b", "v", "x"), ("y",)),
    (layers, (W, B, V, LONG, np.zeros((131, 2))), ("w", "b", "v", "x"), ("y",)),
    (layers, (W, B, V, X[:0], np.zeros((0, 2))), ("w", "b", "v", "x"), ("y",)),
    (recurrent, (W, 0.3 * W.T, X, np.zeros(3)), ("w", "u", "x", "h"), ("return",)),
    (recurrent, (W, 0.1 * W.T, LONG[:70], np.zeros(3)), ("w", "u", "x", "h"), ("return",)),
    (backwards, (W, X, np.zeros((5, 3))), ("w", "x"), ("y",)),
    (in_place, (W, X), ("w", "x"), ("x",)),
    (matrix_that_changes, (W, X, np.zeros((5, 3))), ("w", "x"), ("y", "w")),
    (branches, (W, X), ("w", "x"), ("return",)),
    (early_end, (W, X, np.zeros((5, 3))), ("w", "x"), ("y",)),
    (outer, (W, X, np.zeros((3, 3))), ("w", "x"), ("y",)),
    (from_the_end, (W, X, np.zeros((5, 3))), ("w", "x"), ("y",)),
    (ends_that_change, (W, LONG, np.zeros((131, 3)), np.array([100])), ("w", "x"), ("y",)),
    (from_an_argument, (W, X, np.zeros((5, 3)), -1), ("w", "x"), ("y",)),
    (mixed, (W, X, np.zeros((5, 3))), ("w", "x"), ("y",))]


def cases():
    # derivatives
    for kernel, arguments, wrt, of in CASES:
        yield Case(kernel, arguments, wrt, of)
