"""Loops that run again from snapshots of what flows between iterations; gains added in loops of their own."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.seeds import generator


def stepped(u, steps, c):
    """Many work arrays for one state."""
    for _ in range(steps):
        a = np.sin(u)
        b = a * u * c
        d = np.exp(-b * b)
        e = np.sqrt(1.0 + d * a)
        u[1:-1] += 0.1 * (e[2:] * b[:-2] - d[1:-1])


def read_before_and_after(u, v, steps):
    """The state is read before the loop and after it, and overwritten after it."""
    v *= u * u
    for _ in range(steps):
        a = np.sin(u) * v
        b = a * u * a
        c = np.exp(-b * b)
        d = np.sqrt(2.0 + c * a)
        u[1:] += 0.1 * (d[:-1] * b[1:]) * c[1:]
    v += u * u
    u *= u


def carried_numbers(u, steps):
    """A time that the loop carries, and a sum that it only adds to."""
    t, total = 0.3, 0.0
    for k in range(steps):
        t = t * 1.1 + u[k % 3] * 0.1
        a = np.sin(u * t)
        b = a * u * t
        c = np.exp(-b * b)
        d = c * c * a
        e = np.tanh(d * b)
        total += np.sum(e * c)
        u += 0.1 * (e * d - c)
    return total * t


def inside_another_loop(u, v):
    """The snapshots of a loop that runs several times, an array that no iteration fills, two states."""
    seen = np.zeros(u.size)
    for k in range(2):
        for m in range(k, 3):
            a = np.sin(u) + v
            b = a * u
            c = np.exp(-b * b)
            d = np.sqrt(2.0 + c * a)
            e = np.tanh(d * b) * a
            f = e * d * c
            g = np.cos(f) * f
            seen[m] += g[0] * seen[m - 1] + e[1]
            u += 0.1 * f * d
            v -= 0.05 * g * e
        v *= seen * u
        u[k] *= v[0]


KERNELS = {
    stepped: (lambda r: (0.5 + r.random(6), 3, 0.8), ("u", "c"), ("u",)),
    read_before_and_after: (lambda r: (0.5 + r.random(6), 0.5 + r.random(6), 3), ("u", "v"), ("u", "v")),
    carried_numbers: (lambda r: (0.5 + r.random(4), 4), ("u",), ("u", "return")),
    inside_another_loop: (lambda r: (0.5 + r.random(4), 0.5 + r.random(4)), ("u", "v"), ("u", "v")),
}


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.__name__)
def test_kernel(kernel):
    arguments, wrt, of = KERNELS[kernel]
    given = arguments(generator(2))
    check_derivatives(kernel, given, wrt, of, "numba")
    text = s2sad.differentiate(kernel, engine="numba").adjoint_source(*given)
    assert "where an iteration of" in text.partition('"""\n\n')[0]


def test_no_steps():
    function = s2sad.differentiate(wrt="u", of=("u", "v"), engine="numba")(read_before_and_after)
    u, v, seed = np.array([0.5, 2.0]), np.array([3.0, 4.0]), np.ones(2)
    found = s2sad.vjp(function, (u, v, 0), {"u": seed, "v": seed})
    assert found["u"].tolist() == (2.0 * u * v + 2.0 * u + 2.0 * u).tolist()


def spread(a, b, c):
    """Rows gain from both sides, forwards and backwards, by names that are bound again."""
    for i in range(b.shape[0] - 1):
        for j in range(b.shape[1] - 1):
            g = c[i, j] * b[i, j]
            a[i, j] = a[i, j] * g + b[i, j + 1] * b[i + 1, j]
            g = g * b[i + 1, j + 1]
            a[i, j] += g * g
    for i in range(b.shape[0] - 1, 0, -1):
        for j in range(b.shape[1] - 1, 1, -1):
            a[i, j] += c[i, j] * (b[i - 1, j] - b[i, j - 2] * b[i, j])


def test_gains_in_loops_of_their_own():
    random = generator(4)
    given = tuple(0.5 + random.random((4, 5)) for _ in range(3))
    function = s2sad.differentiate(spread, engine="numba")
    assert "_gains, top = allocate_zeros(" in function.adjoint_source(*given, level="fast")
    check_derivatives(spread, given, ("a", "b", "c"), ("a",), "numba")
    text = {level: function.adjoint_source(*given, level=level) for level in ("plain", "fast")}
    found = []
    for source in text.values():
        space: dict = {}
        exec(compile(source, "adjoint", "exec"), space)  # the same sums in the same order, whatever the loops
        arrays = [x.copy() for x in given]
        shadows = [np.ones_like(arrays[0]), *(np.zeros_like(x) for x in arrays[1:])]
        space["spread_adjoint"](*(x for pair in zip(arrays, shadows) for x in pair))
        found.append(shadows)
    assert all(np.array_equal(p, q) for p, q in zip(*found))
