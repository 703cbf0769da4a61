"""Kernels with slices, views, broadcasting, reductions and linear algebra, under both engines."""
from __future__ import annotations

import numpy as np
import pytest

from benchmarks.kernels.cases import ARRAYS
from tests.derivatives import check_derivatives

ENGINES = ("numpy", "numba")


def overlapping_store(x, y):
    x[1:] = x[:-1] * y[1:]
    x[:-1] += x[1:] * x[1:]
    x[::-1] = x * y


def strided(x, y):
    x[::2] = y[::2] * x[::2]
    x[1::2] -= x[:-1:2] * y[1::2]
    y[3:0:-1] *= x[1:4]


def view_of_a_view(x, y):
    inner = x[1:-1]
    part = inner[1:]
    part *= y[2:-1] * inner[:-1]
    inner[0] = part[0] * part[-1]
    part[1:] = inner[:-2] ** 2


def view_kept_across_a_rebinding(x, y):
    row = x[1:]
    y[:-1] *= row
    row = x[:-1]
    row += y[1:] * row
    y[1:] += row * row


def read_after_the_view_was_overwritten(x, y):
    part = x[2:]
    old = part.copy()
    part[...] = y[2:] * old
    y[2:] += part * old


def broadcast_both_ways(a, x, y):
    a += x[:, None] * y[None, :]
    a *= a[0] + x[1]
    b = np.exp(0.1 * a) * y
    x += b[:, 0] * b[:, -1]
    y *= np.sum(b, axis=0)


def broadcast_in_a_sum(a, x, y):
    return np.sum(a * y) + np.sum(x[:, None] * y) + np.sum(x[:, None] + y) + np.sum((a + y) * x[:, None] ** 2)


def reductions(a, x, y):
    rows = np.sum(a, axis=1)
    columns = a.mean(axis=0)
    x *= rows
    y[:] = y * columns + a.max(axis=0) - np.min(a, axis=0)
    return np.sum(a) * np.mean(x) + np.max(y) * a.min() + np.sum(np.sum(a * a, axis=0, keepdims=True) * y)


def kept_dimensions(a, x, y):
    a -= a.mean(axis=1, keepdims=True)
    a /= np.sum(a * a, axis=(0, 1), keepdims=True)
    a[...] = a - np.max(a, axis=-1, keepdims=True)
    return np.sum(a * x[:, None]) + y[0]


def moved(a, x, y):
    b = np.roll(a, 1, axis=0) * np.roll(a, -2, axis=1)
    a += np.flip(b, axis=1) * b
    x[:] = np.roll(x, 1) * x[::-1]
    c = a.T * y[:, None]
    return np.sum(c * np.outer(y, x)) + np.sum(a.reshape(-1) ** 3) + np.sum(np.ravel(c) * a.reshape((12,)))


def products(a, x, y):
    b = a @ y
    x += b * x
    y *= a.T @ x
    c = a.T @ a
    c += np.outer(y, y)
    return np.dot(x, b) + np.sum(c @ c) + np.sum(x @ a)


def chosen(a, x, y):
    b = np.where(a > 0.5, a * a, np.sqrt(a))
    b[0, :] = np.where(y > x[0], y, 0.0)
    a[:, 1:] = np.maximum(b[:, 1:], a[:, :-1]) * np.clip(a[:, 1:], 0.2, 0.8)


def in_loops(a, x, y):
    for k in range(3):
        part = a[k]
        part[1:] += part[:-1] * y[1:]
        a[:, k] *= x
        t = a[:, 1:] - a[:, :-1]
        x += t[:, 0] * t[:, k]
        y[1:] -= 0.1 * np.sum(t * t, axis=0)


def window(x, y):
    for k in range(x.size - 2):
        x[k:k + 2] += y[k + 1:k + 3] * x[k]
        y[k] = np.sum(x[k:k + 3]) * y[k]


def scaled(part, c):
    part *= c
    part[1:] += part[:-1] * part[0]


def part_passed_to_a_helper(a, x, y):
    scaled(a[1], y[0])
    scaled(a[:, 2], x[1])
    scaled(x[1:], a[0, 0])


def batched_rows(a, x, y):
    s = np.empty((3, 1))
    s[:, 0] = x * x
    a *= s
    d = a - s * np.ones(4)
    return np.sum(d * d * y)


def masked(x, y):
    mask = x > 0.9
    x[mask] *= y[mask] + x[mask] ** 2
    y[x < 1.0] = 0.3
    x[~mask] += 0.5 * np.sum(y[mask] ** 2)
    part = x[mask] * x[mask]
    mask[0] = False
    y[mask] -= x[mask] * 0.1
    x[mask] = x[mask] ** 3
    return np.sum(part * part)


def mask_that_changes(x, y):
    for _ in range(3):
        low = x < y
        x[low] = x[low] * x[low] + 0.7
        y[low] *= 0.9 * x[low]
        x -= 0.05 * y


def masked_matrix(a, x, y):
    high = a > 0.6
    a[high] = np.sqrt(a[high]) * x[0]
    rows = x > 0.8
    a[rows] *= y
    a[rows, 1:] += x[1]
    return np.sum(a[high]) * np.sum(a[rows] ** 2)


def picked_elements(x, y):
    places = np.array([0, 2, 2, 5])
    y[:4] *= x[places] * x[places]
    x[places] = y[:4] * y[1:5]
    x[places] += y[places] * x[0]
    z = x[places]
    return np.sum(z * z) + x[places[1]] * y[-1]


def picked_twice_in_a_loop(x, y):
    places = np.array([1, 1, 3])
    for k in range(3):
        x[places] *= y[places + k % 2] * x[k]
        places[0] = (places[0] + 1) % 4
        y[places] = np.sin(x[places])


THREE = (overlapping_store, strided, view_of_a_view, view_kept_across_a_rebinding, read_after_the_view_was_overwritten,
         window, masked, mask_that_changes, picked_elements, picked_twice_in_a_loop)
KERNELS = (*THREE, masked_matrix, broadcast_both_ways, broadcast_in_a_sum, reductions, kept_dimensions, moved,
           products, chosen, in_loops, part_passed_to_a_helper, batched_rows)


def arguments(kernel):
    random = np.random.default_rng(11)
    if kernel in THREE:
        return 0.5 + random.random(6), 0.5 + random.random(6)
    return 0.3 + 0.7 * random.random((3, 4)), 0.5 + random.random(3), 0.5 + random.random(4)


def outputs(kernel, names):
    given, left = arguments(kernel), arguments(kernel)
    result = kernel(*left)
    changed = tuple(n for n, a, b in zip(names, given, left) if not np.array_equal(a, b))
    return changed + (("return",) if result is not None else ())


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.__name__)
def test_kernel(kernel, engine):
    names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
    check_derivatives(kernel, arguments(kernel), names, outputs(kernel, names), engine)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("case", ARRAYS, ids=lambda case: case.name)
def test_case(case, engine):
    check_derivatives(case.function, case.arguments("small"), case.wrt, case.of, engine)
