"""What an exponential gave an iteration is kept in it, and only where it is the same later on."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([[0.3, -0.9, 0.7, 0.2], [0.5, 0.1, -0.4, 0.8]])


def overwritten(x, w):
    total = 0.0
    for i in range(x.shape[0]):
        e = np.exp(w * x[i])
        e /= np.sum(e)
        total += np.sum(e * x[i] ** 2)
    return total


def hyperbolic(x, w):
    total = 0.0
    for i in range(x.shape[0]):
        h = np.tanh(w * x[i] + 0.1)
        total += np.sum(np.sin(h) * np.sum(h))
    return total


def in_place_of_its_array(x, w):
    total = 0.0
    for i in range(x.shape[0]):
        e = np.exp(w * x[i])
        total += np.sum(e) ** 2
    return total


def argument_moves(x, w):
    e = np.empty_like(w)
    for i in range(x.shape[0]):
        for j in range(w.size):
            e[j] = np.exp(w[j] * x[i, j])
        for j in range(w.size):
            w[j] += 0.1 * e[j]
        for j in range(w.size):
            x[i, j] += e[j] * np.exp(w[j] * x[i, j])


def one_more(x, w):
    e = np.zeros(w.size)
    for i in range(x.shape[0]):
        for j in range(w.size - 1):
            e[j] = np.exp(w[j] * x[i, j])
        for j in range(w.size):
            e[j] = e[j] ** 2 + np.exp(w[j] * x[i, j])
        for j in range(w.size):
            x[i, j] = e[j] * np.sin(e[j])


def only_inside(x, w):
    for i in range(x.shape[0]):
        for j in range(w.size):
            e = np.exp(w[j + 1]) if j < w.size - 1 else 0.5
            x[i, j] = e * x[i, j] ** 2
        for j in range(w.size):
            x[i, j] *= np.exp(np.sin(x[i, j]))


def of_a_moving_name(x, w):
    for i in range(x.shape[0]):
        t = 0.5
        for j in range(w.size):
            e = np.exp(t * x[i, j])
            e = e * e
            w[j] += e
        t = np.sum(w)
        for j in range(w.size):
            x[i, j] = np.exp(t * 0.01 * x[i, j]) * w[j]


def twice_in_one(x, w):
    for i in range(x.shape[0]):
        a, b = np.exp(x[i]), np.exp(w)
        p = a * b
        a *= p
        b *= a
        x[i] += np.exp(x[i]) * b + np.exp(w) * a


def both(x, w):
    n, m = x.shape
    out = 0.0
    for s in range(2):
        h = np.tanh(x * w + s)
        g = np.exp(x * 0.5)
        h *= g
        g *= h
        x += 0.1 * h * g
        out += np.sum(h ** 2)
    return out


def at_the_top(x, w):
    e = np.exp(x - np.max(x, axis=-1, keepdims=True))
    return np.sum(e / np.sum(e, axis=-1, keepdims=True) * w)


def at_the_top_overwritten(x, w):
    e = np.exp(x * w)
    e /= np.sum(e)
    return np.sum(e * e * x)


def at_the_top_of_what_moves(x, w):
    e = np.exp(x * w)
    x += 0.1 * e
    f = np.exp(x * w)
    w += 0.1 * np.sum(f * e, axis=0)
    return np.sum(f * e) + np.sum(np.exp(x * w))


def at_the_top_in_a_branch(x, w):
    e = np.zeros_like(x)
    if w[0] > 0.0:
        e[:] = np.exp(x * w)
    else:
        e[:] = np.exp(x * w * 2.0)
    return np.sum(e * np.exp(x * w))


TURN = 0.5j


def of_complex_numbers(x, w):
    z = np.zeros(w.size, np.complex128)
    for i in range(x.shape[0]):
        z[:] = x[i] + 0.1j
        z *= np.exp(TURN * w * x[i])
        z[:] = np.fft.ifft(np.exp(-0.5j * w) * np.fft.fft(z))
        z *= np.exp(TURN * w * x[i]) * np.exp(-0.5j * w)
        x[i] += np.abs(z) ** 2


def cases():
    w = np.array([0.4, -0.3, 0.6, 0.9])
    for kernel in (overwritten, hyperbolic, in_place_of_its_array, both, at_the_top, at_the_top_overwritten,
                   at_the_top_in_a_branch):
        yield Case(kernel, (X, w), ("x", "w"))
    for kernel in (of_complex_numbers, argument_moves, one_more, only_inside, of_a_moving_name, twice_in_one,
                   at_the_top_of_what_moves):
        yield Case(kernel, (X, w), ("x", "w"), ("x",))
