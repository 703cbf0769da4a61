"""Arrays that one statement only hands to the next are numbers in the loops for Numba, and are not recorded."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import differentiate, explain
from tests.called_kernels import asserted_between
from tests.derivatives import check_derivatives
from tests.engines import each
from tests.seeds import generator

RNG = generator(11)
U, V = RNG.random((4, 5)) + 0.5, RNG.random((4, 5)) + 0.5


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


KERNELS = [(relaxed, (RNG.random((3, 4, 5)), U, V, 0.3), ("f", "u", "v", "rate"), ("f",)),
           (read_later, (U, V), ("u", "v"), ("v", "return")), (of_neighbours, (U, V), ("u", "v"), ("u", "v")),
           (of_itself, (U, V), ("u", "v"), ("u",)), (kept_between, (U, V), ("u", "v"), ("v",)),
           (in_loops, (U, V), ("u", "v"), ("v",)), (one_after_the_other, (U, V), ("u", "v"), ("v",)),
           (picked, (U, V), ("u", "v"), ("v",)), (in_a_branch, (U, V), ("u", "v"), ("u", "v")),
           (changed_between, (U, V, 0.7), ("u", "v", "a"), ("v",)), (scaled_twice, (U, V), ("u", "v"), ("v",)),
           (asserted_between, (U, V), ("u", "v"), ("v",))]


@pytest.mark.parametrize(("kernel", "arguments", "wrt", "of", "engine"), each(KERNELS))
def test_gradients(kernel, arguments, wrt, of, engine):
    check_derivatives(kernel, arguments, wrt, of, engine=engine)


def test_what_is_handed_on_is_not_recorded():
    found = explain(differentiate(relaxed, wrt=("f", "u", "v", "rate"), of=("f",), engine="numba"),
                    RNG.random((3, 4, 5)), U, V, 0.3)
    text = str(found)
    assert "speed_stack" not in text and "target_stack" not in text, text
    assert "target: float64[:, :], active" in text, text


def test_what_nothing_reads_is_not_filled():
    text = differentiate(relaxed, wrt=("f",), of=("f",), engine="numba").adjoint_source(
        RNG.random((3, 4, 5)), U, V, 0.3)
    assert "speed[" not in text and "target[" not in text, text
