"""Elements that arrays pick from an expression, which has no name: `np.sqrt(x)[x > 0]`."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

V = np.array([0.3, 1.2, 0.8, 2.0])
A = generator(1).normal(size=(4, 5))


def places(v):
    return np.sum((v * 2.0)[np.array([0, 1])] ** 2)


def mask(v):
    return np.sum(np.sqrt(v)[v > 0.5])


def several(v):
    i = np.array([2, 0, 0])
    return np.sum((-v)[i] * np.abs(v)[i]) + np.sum(np.exp(v)[v < 1.0])


def places_on_two_axes(a):
    i = np.array([0, 2, 2, 4])
    return np.sum((a * 1.3)[np.arange(4), i] ** 2)


def stored(v):
    m = v > 0.5
    v[m] = (v * 1.3)[m] + np.sin(v)[m]
    v[(v * 1.3) > 1.0] *= 0.5
    return np.sum(v * v)


def in_a_loop(v):
    y = v.copy()
    for _ in range(3):
        y[1:] += (y * 0.5)[np.array([0, 1, 2])]
    return np.sum((v * y)[y > 0.4])


def of_a_product(a):
    return np.sum((a @ a.T)[np.triu_indices(4, 1)] ** 2) + np.sum((a * 2)[a > 0])


def of_what_is_picked(v):
    v[[0, 1, 1]][[0, 2]] *= 2.0         # a copy
    picked = v[[0, 2, 3]][[1, 1]]
    return np.sum(picked ** 2) * v[v > 0.0][[0, 1]].sum()


def of_columns(a):
    picked = a[..., [0, 1]][[0, 2]]
    return picked.shape[0] * np.sum(picked ** 2) + np.sum(a[:, [0, 2]][1:][:, 1] ** 2)


def spread_of(y):
    m = y.mean()
    return ((y - m) ** 2).sum()


def filled(a):
    for i in range(1, a.size):
        a[i] += 0.5 * a[i - 1] ** 2
    return a[0] * a[-1]


def given_to_a_function(v):
    i = np.array([2, 0, 0])
    return spread_of(v[i]) + spread_of(v[[0, 1]]) * v[0]


def filled_by_a_function(v):
    total = 0.0
    for k in range(2):
        total += filled(v[np.array([2, 0, 0])])     # the copy is filled
        v[k] += total
    return total * np.sum(v ** 2)


def columns_given_to_a_function(a):
    i = np.array([0, 2, 2])
    return spread_of(a[i, 1]) + spread_of(a[1, i]) * spread_of(a[2][i])


CASES = [(f, V, "v") for f in (places, mask, several, stored, in_a_loop, of_what_is_picked,
                              given_to_a_function, filled_by_a_function)] + [
    (f, A, "a") for f in (places_on_two_axes, of_a_product, of_columns, columns_given_to_a_function)]


def cases():
    # gradients
    for kernel, argument, wrt in CASES:
        yield Case(kernel, (argument.copy(),), (wrt,))
