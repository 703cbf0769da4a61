"""Functions of numbers that loops call: names of their own, the order of evaluation, and what stays a call."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, -0.9, 0.7, 0.2, 0.5])
Y = np.array([0.4, 0.6, -0.2, 1.1, 0.9])


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-x))


def rebinds(x):
    x = x * x + 0.1
    t = np.tanh(x)
    x *= t
    return x + t


def both(x, y):
    e = np.exp(x - y)
    return e * y, e + np.sin(x)


def nested(x):
    return sigmoid(x) * sigmoid(2.0 * x)


def chosen(x):
    if x > 0.0:
        return np.exp(-x)
    return 1.0 + x * x


def power_of(x, k):
    return np.log(1.0 + x * x) ** k


def own_names(x, y):
    """The caller has names that the functions have, too."""
    t = 0.5
    for i in range(x.size):
        e = x[i] * t
        x[i] = rebinds(e) + t
        y[i] += e * t


def swapped(x, y):
    for i in range(x.size):
        a, b = x[i], y[i]
        a, b = both(b, a)
        x[i] = a
        y[i] = b


def of_itself(x):
    total = 0.0
    for i in range(x.size):
        total += sigmoid(sigmoid(x[i]) - nested(x[i]))
    return total


def where_it_is_asked(x, y):
    for i in range(x.size):
        y[i] = sigmoid(x[i]) if x[i] > 0.0 else chosen(x[i]) * y[i]
        if sigmoid(y[i]) > 0.6:
            y[i] *= nested(x[i])


def of_what_is_stored(x, y):
    for i in range(x.size - 1):
        y[i] += sigmoid(y[i + 1] * x[i])
        x[i + 1] *= nested(y[i])


def of_integers(x):
    total = 0.0
    for i in range(x.size):
        total += power_of(x[i], i)
    return total


def until_small(x):
    d, k = 1.0, 0
    while d > 0.02 and k < 30:
        d = sigmoid(d * x[0]) * d
        k += 1
    return d


def in_front_of_loops(x):
    s = sigmoid(x[0])
    for i in range(x.size):
        x[i] = s * sigmoid(x[i])


def step(h, c, w):
    for i in range(h.size):
        c[i] = c[i] * sigmoid(h[i] * w[i]) + sigmoid(w[i])
        h[i] = np.tanh(c[i]) * sigmoid(h[i])


def layers(x, y, w):
    for k in range(w.shape[0] - 1):
        step(x, y, w[k])
        step(y, x, w[k + 1])


def rows(w, y):
    for _ in range(2):
        for k in range(w.shape[0] - 1):
            step(w[k], w[k + 1], y)


def sequence(state, w, x):
    total = 0.0
    for t in range(x.shape[0]):
        for k in range(w.shape[0]):
            step(state[k], state[k + 1], w[k])
            total += state[k, 0] * x[t, 1]
        state[0] += x[t]
    return total


def cases():
    w = np.array([[0.3, -0.2, 0.5, 0.1, 0.8], [0.7, 0.4, -0.6, 0.2, 0.3], [0.2, 0.9, 0.1, -0.5, 0.6]])
    for kernel in (own_names, swapped, of_what_is_stored):
        yield Case(kernel, (X, Y), ("x", "y"), ("x", "y"))
    yield Case(where_it_is_asked, (X, Y), ("x", "y"), ("y",))
    for kernel in (of_itself, of_integers, until_small):
        yield Case(kernel, (X,), "x")
    yield Case(in_front_of_loops, (X,), "x", ("x",))
    yield Case(layers, (X, Y, w), ("x", "y", "w"), ("x", "y"))
    yield Case(rows, (w, Y), ("w", "y"), ("w",))
    yield Case(sequence, (w, w[:2] + 0.1, w[::-1].copy()), ("state", "w", "x"))
