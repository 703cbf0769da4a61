"""Arrays that one statement only hands to the next are numbers in the loops for Numba, and are not recorded."""
from __future__ import annotations

import numpy as np

from tests.interface.kernels import asserted_between
from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(11)
U, V = RNG.random((4, 5)) + 0.5, RNG.random((4, 5)) + 0.5
F = RNG.random((3, 4, 5))


def relaxed(f, u, v, rate):
    """`speed` and `target` are handed on in each iteration."""
    for q in range(f.shape[0]):
        speed = 3.0 * (q * u + v)
        target = 1.0 + speed + 0.5 * speed ** 2
        f[q] += rate * (target * u - f[q])


def read_later(u, v):
    w = 2.0 * u
    v *= w
    return np.sum(w ** 2)


def of_neighbours(u, v):
    for _ in range(3):
        w = u[1:, :] - u[:-1, :]
        v[:-1, :] += w * u[1:, :]
        u[1:, :] += 0.1 * w


def of_itself(u, v):
    """`w` reads what the next statement overwrites."""
    for _ in range(3):
        w = u[:, ::-1] * v
        u += w * u


def kept_between(u, v):
    """`w` is filled in one iteration and read in the next."""
    w = np.zeros_like(u)
    for k in range(3):
        v += w * u
        w[...] = u * v + k


def in_loops(u, v):
    n = u.shape[1]
    w = np.empty(n)
    for i in range(u.shape[0]):
        for j in range(n):
            w[j] = np.sin(u[i, j]) * v[i, j]
        for j in range(n):
            v[i, j] = w[j] * w[j]


def one_after_the_other(u, v):
    n = u.shape[1]
    w = np.empty(n)
    for i in range(u.shape[0]):
        for j in range(n):
            w[j] = u[i, j] * v[i, j]
        for j in range(1, n):
            v[i, j] = w[j - 1] * w[j]


def picked(u, v):
    for _ in range(2):
        w = u * v
        v[w > 0.6] = 0.5 * w[w > 0.6]


def in_a_branch(u, v):
    for k in range(4):
        w = u * (1.0 + k)
        if k % 2:
            v += w * v
        else:
            u *= 1.0 + 0.1 * w


def changed_between(u, v, a):
    for _ in range(3):
        w = a * u
        a = a * 0.5 + u[0, 0]
        v += w * w * a


def scaled_twice(u, v):
    w = u / v
    w *= u
    v += w


def of_integers(u, v):
    """What the array holds are floats, whatever is stored into it: integers have other powers."""
    w = np.empty(u.shape[1])
    for i in range(u.shape[0]):
        for j in range(u.shape[1]):
            w[j] = i + j + 1
            if j == 2:
                w[j] = 3
            v[i, j] = v[i, j] * u[i, j] ** 2 * w[j] ** -1


def of_one_integer(u, v):
    w = np.empty_like(u)
    w[...] = 3
    v *= u * u * w ** -1


def of_flags(u, v):
    w = np.empty_like(u)
    for i in range(u.shape[0]):
        for j in range(u.shape[1]):
            w[i, j] = u[i, j] > 0.8
            v[i, j] *= u[i, j] * (w[i, j] + w[i, j] + 1.0)


def filled_by_two_loops(u, v):
    """Each of the loops fills the row before it reads it."""
    w = np.empty(u.shape[1])
    for i in range(u.shape[0]):
        for j in range(w.shape[0]):
            w[j] = np.sin(u[i, j]) * v[i, j]
            v[i, j] = v[i, j] * w[j]
    for i in range(u.shape[0] - 1, -1, -1):
        for j in range(w.shape[0]):
            w[j] = u[i, j] * v[i, j]
            u[i, j] = w[j] * w[j]


def left_by_the_first_loop(u, v):
    """The second loop reads what the last iteration of the first has left."""
    w = np.empty(u.shape[1])
    for i in range(u.shape[0]):
        for j in range(w.shape[0]):
            w[j] = np.sin(u[i, j]) * v[i, j]
            v[i, j] = v[i, j] * w[j]
    for i in range(u.shape[0]):
        for j in range(w.shape[0]):
            u[i, j] = w[j] * v[i, j]
            w[j] = u[i, j]


def cases():
    yield Case(relaxed, (F, U, V, 0.3), ("f", "u", "v", "rate"), ("f",))
    yield Case(read_later, (U, V), ("u", "v"), ("v", "return"))
    for kernel in (of_neighbours, in_a_branch):
        yield Case(kernel, (U, V), ("u", "v"), ("u", "v"))
    yield Case(of_itself, (U, V), ("u", "v"), ("u",))
    for kernel in (kept_between, in_loops, one_after_the_other, picked, scaled_twice, asserted_between):
        yield Case(kernel, (U, V), ("u", "v"), ("v",))
    yield Case(changed_between, (U, V, 0.7), ("u", "v", "a"), ("v",))
    for kernel in (of_integers, of_one_integer, of_flags):
        yield Case(kernel, (U, V), ("u", "v"), ("v",))
    for kernel in (filled_by_two_loops, left_by_the_first_loop):
        yield Case(kernel, (U, V), ("u", "v"), ("u", "v"))
