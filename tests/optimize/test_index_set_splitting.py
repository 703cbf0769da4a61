"""Indices that go around an axis: the loops without remainders do the same."""
from __future__ import annotations

import numpy as np
import pytest

from benchmarks.kernels.cases import Case
from s2sad import pipeline, read
from s2sad.infer.types import of_value
from s2sad.program import Request
from tests.optimize.test_levels import same, texts


def by_numbers(u, v):
    v[:] = np.roll(u, 1) * np.roll(u, -2) - u * np.roll(u, 1)


def far(u, v):
    v[:] = np.roll(u, 9) * u


def by_a_name(u, v, k):
    v[:] = np.roll(u, k) ** 2 + u


def by_two_names(u, v, k):
    v[:] = np.roll(u, k) * np.roll(u, -k)


def on_both_axes(m, r, k):
    for s in range(2):
        r[:] = r * np.roll(np.roll(m, k - s, axis=0), 1 - k, axis=1)


def by_hand(u, v):
    n = u.size
    for i in range(n):
        v[i] = u[(i + 1) % n] * u[i - 1] - u[(i + n - 1) % n] ** 2


def where_its_own_element_says(u, v):
    m = np.empty((4, 3))
    for i in range(4):
        m[i] = u[i] + v[:3]
    m[1:, int(abs(m[1, 0]) * 7.3) % 3] *= 0.4
    v[:3] = m[2] * m[1]


def test_a_place_that_the_store_itself_moves():
    both_levels(where_its_own_element_says, (np.linspace(0.5, 1.5, 4), np.linspace(0.1, 0.3, 4)), ("u", "v"), ("v",))


def said(value):
    return getattr(value, "__name__", str(value))


@pytest.mark.parametrize("size", [1, 2, 3, 7])
@pytest.mark.parametrize("kernel, shifts", [(by_numbers, ()), (far, ()), (by_a_name, (3,)), (by_a_name, (-8,)),
                                            (by_two_names, (2,)), (by_hand, ())], ids=said)
def test_rows(kernel, shifts, size):
    both_levels(kernel, (np.linspace(0.5, 1.5, size), np.ones(size), *shifts), ("u",), ("v",))


@pytest.mark.parametrize("sizes", [(1, 4), (3, 1), (4, 5)], ids=str)
def test_both_axes(sizes):
    both_levels(on_both_axes, (np.linspace(0.5, 1.5, sizes[0] * sizes[1]).reshape(sizes), np.ones(sizes), 2),
                ("m", "r"), ("r",))


def both_levels(kernel, arguments, wrt, of):
    def fresh():
        return tuple(a.copy() if isinstance(a, np.ndarray) else a for a in arguments)
    same(Case(kernel.__name__, kernel, lambda _: fresh(), wrt, of))
    generated = pipeline.derive(read.load(kernel), Request(
        "primal", tuple(map(of_value, arguments)), (), (), "numba", "fast"))
    space: dict = {}
    exec(generated.text, space)
    expected, found = fresh(), fresh()
    kernel(*expected)
    space[generated.entry](*found)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-15)


@pytest.mark.parametrize("kernel, shifts", [(by_a_name, (3,)), (far, ())], ids=said)
def test_no_remainder_is_left_in_a_loop(kernel, shifts):
    fast = texts(kernel, (np.ones(5), np.ones(5), *shifts), ("u",), ("v",))[1].text
    assert all("%" not in line.split("]")[0] or "max(" in line for line in fast.splitlines() if "u_bar[" in line)
    assert "turn" in fast
