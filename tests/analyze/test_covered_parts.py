"""Work arrays that an iteration fills in parts before it reads them are not recorded; what parts leave out is."""
from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import s2sad


def ends_apart(u, c, n):
    a, b = np.zeros_like(u), np.zeros_like(u)
    for _k in range(n):
        a[:] = np.sin(u) * c
        b[1:-1] = a[2:] - a[:-2]
        b[0] = a[0]
        b[-1] = a[-1]
        u += 0.1 * b * b
    return np.sum(u * u)


def in_loops(u, c, n):
    b = np.zeros_like(u)
    for _k in range(n):
        b[0] = u[0]
        b[u.size - 1] = c * u[0]
        for i in range(1, u.size - 1):
            b[i] = c * u[i - 1] * u[i + 1]
        for i in range(u.size):
            u[i] += 0.1 * b[i] * b[i]
    return np.sum(u * u)


def shifted_in_loops(u, c, n):
    b = np.zeros_like(u)
    for _k in range(n):
        for i in range(u.size - 1, 0, -1):
            b[i - 1] = c * u[i] * u[i - 1]
        b[-1] = u[-1]
        for i in range(u.size):
            u[i] += 0.1 * b[i] * b[i]
    return np.sum(u * u)


def overlapping(u, c, n):
    b = np.zeros_like(u)
    for _k in range(n):
        b[:3] = c * u[:3]
        b[2:] = u[2:] * u[2:]
        u += 0.1 * b * b
    return np.sum(u * u)


def frame(u, c, n):
    """All of two axes: the inner cells, two rows, two columns."""
    v = np.outer(u, u)
    b = np.zeros_like(v)
    for _k in range(n):
        b[1:-1, 1:-1] = c * v[2:, 1:-1] * v[1:-1, 2:]
        b[0] = v[0]
        b[-1] = c * v[-1]
        b[:, 0] = v[:, 0] * v[:, 0]
        b[:, -1] = v[:, -1]
        v += 0.1 * b * b
    return np.sum(v * v)


def shared_out(u, c, n):
    """At a place that the iteration does not change, and that is positive where there is one."""
    b = np.zeros_like(u)
    for _k in range(n):
        b[:n] = c * u[:n]
        b[n:] = u[n:] * u[n:]
        u += 0.1 * b * b
    return np.sum(u * u)


FILLED = (ends_apart, in_loops, shifted_in_loops, overlapping, frame, shared_out)


def hole_of_one(u, c, n):
    b = np.zeros_like(u)
    for _k in range(n):
        b[1:-2] = c * u[1:-2]
        b[0] = u[0]
        b[-1] = u[-1]
        b[-2] *= c + b[0]
        u += 0.1 * b * b
    return np.sum(u * u)


def hole_in_long_ones(u, c, n):
    """None up to six elements."""
    b = np.zeros_like(u)
    for _k in range(n):
        b[3:] *= c * u[0] + 0.5
        b[:3] = c * u[:3]
        b[-3:] = u[-3:]
        u += 0.1 * b * b
    return np.sum(u * u)


def in_one_branch(u, c, n):
    b = np.ones_like(u)
    for _k in range(n):
        b[1:] = c * u[1:]
        if u[0] > 0.23:
            b[0] = u[0]
        u += 0.1 * b * b
    return np.sum(u * u)


def read_before(u, c, n):
    b = np.zeros_like(u)
    for _k in range(n):
        b[1:] = c * u[1:]
        u[0] += b[0] * u[1]
        b[0] = u[0]
        u += 0.1 * b * b
    return np.sum(u * u)


def left_early(u, c, n):
    b = np.ones_like(u)
    for _k in range(n):
        b[0] = u[0]
        for i in range(1, u.size):
            if u[i] > 0.45:
                break
            b[i] = c * u[i]
        u += 0.1 * b * b
    return np.sum(u * u)


def at_places_that_move(u, c, n):
    b = np.ones_like(u)
    for k in range(n):
        b[k % 3:] = c * u[k % 3:]
        b[0] = u[0]
        u += 0.1 * b * b
    return np.sum(u * u)


def perhaps_from_the_end(u, c, n):
    """The first part begins at n - 4, which may be negative."""
    b = np.ones_like(u)
    for _k in range(n):
        b[n - 4:] = c * u[n - 4:]
        b[:1] = u[:1]
        u += 0.1 * b * b
    return np.sum(u * u)


def part_of_a_triangle(u, c, n):
    v = np.outer(u, u)
    b = np.ones_like(v)
    for _k in range(n):
        for i in range(v.shape[0]):
            for j in range(i, v.shape[0]):
                b[i, j] = c * v[i, j]
        b[0] = v[0]
        v += 0.1 * b * b
    return np.sum(v * v)


def every_second(u, c, n):
    b = np.ones_like(u)
    for _k in range(n):
        b[::2] = c * u[::2]
        b[-1] = u[-1]
        u += 0.1 * b * b
    return np.sum(u * u)


LEFT_OUT = (hole_of_one, hole_in_long_ones, in_one_branch, read_before, left_early, at_places_that_move,
            perhaps_from_the_end, part_of_a_triangle, every_second)


def _recorded(kernel, engine: str) -> list[str]:
    """The stacks of the work array, under Numba also of its elements."""
    text = s2sad.differentiate(kernel, engine=engine, memory="least").adjoint_source(np.ones(7), 0.3, 6)
    return re.findall(r"\bb_\w*stack", text)


def _compared(kernel, size: int, n: int, engine: str) -> None:
    u, direction, h = np.linspace(0.1, 0.6, size), np.cos(np.arange(size)), 1e-6
    measured = (kernel(u + h * direction, 0.3, n) - kernel(u - h * direction, 0.3, n)) / (2 * h)
    plain = None
    loop = next(v for v in kernel.__code__.co_varnames if v in ("k", "_k"))
    ways: tuple[dict[str, Any], ...] = ({"memory": "fastest"}, {"memory": "least"}, {}, {"checkpoint": {loop: 2}})
    for options in ways:
        found = s2sad.gradient(s2sad.differentiate(kernel, engine=engine, **options), wrt="u")(u, 0.3, n)
        np.testing.assert_allclose(found @ direction, measured, rtol=1e-6, atol=1e-8)
        plain = found if plain is None else plain
        np.testing.assert_allclose(found, plain, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("kernel", (*FILLED, *LEFT_OUT), ids=lambda k: k.__name__)
def test_gradients_whatever_is_recorded(kernel):
    """Where parts overlap or leave a hole, too."""
    for size in (7, 6, 5, 3, 2) if kernel in LEFT_OUT else (7, 4, 3, 2, 1):
        if (kernel, size) not in ((hole_of_one, 2), (hole_in_long_ones, 2), (in_loops, 1)):
            for n in (1, 6):
                _compared(kernel, size, n, "numpy")


@pytest.mark.parametrize("kernel", (*FILLED, *LEFT_OUT), ids=lambda k: k.__name__)
def test_gradients_under_numba(kernel):
    _compared(kernel, 7, 6, "numba")


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", FILLED, ids=lambda k: k.__name__)
def test_what_is_filled_in_parts_is_not_recorded(kernel, engine):
    """Loops in place of slices that may end behind the array have bounds that are not affine."""
    if engine == "numba" and kernel in (overlapping, shared_out):
        assert _recorded(kernel, engine)
        return
    assert not _recorded(kernel, engine)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", LEFT_OUT, ids=lambda k: k.__name__)
def test_what_parts_leave_out_is_recorded(kernel, engine):
    assert _recorded(kernel, engine)
