"""Lists and copies that are stored into arrays, lists as subscripts, and rolls of several axes."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def lists(a, x, y):
    y[1:3] = [x[0], x[1] * x[0]]
    a[:, 1] = [1.0, x[0], x[2]]
    a[0, :] = (1.0, x[0], x[2], 3.0)
    x += [1.0, x[0], 2.0]
    a[[0, 1]] = a[[1, 0]]
    return np.sum(y * y) + np.sum(a ** 2) + np.sum(a[[0, 2, 2]] * a[:, [0]]) + np.sum(y[[True, False, True, True]])


def copies(a, x, y):
    a[0], a[2] = a[2].copy(), a[0].copy()
    a[1] = 2.0 * a[2].copy() + np.copy(y)
    z = np.asarray(x) * np.array([x[0], 2.0, x[1]])
    c = np.array(a)
    c[1] += np.array(a[0]) * y
    return np.sum(a[0] * y) + np.sum(z) + np.sum(c * c) + np.sum(np.copy(x) * x)


def rolled(a, x, y):
    a *= np.roll(a, 3) * np.roll(a, (1, 2), axis=(0, 1))
    return np.sum(np.roll(a, 1, axis=(0, 1)) * a * a) + np.sum(np.roll(a, -5) ** 2 * y)


def element_of_a_list(a, x, y):
    held = [0.0] * 3
    held[0] = x[0] * x[1]
    return np.sum(np.array(held) * x) + y[0] * a[0, 0]


def searchsorted(a, x, y):
    """A kernel under the name of a library's function that it calls."""
    return y[np.searchsorted(x, 1.5) - 1] ** 2


KERNELS = (lists, copies, rolled, element_of_a_list, searchsorted)


def copy_of_a_number(x):
    x[0] = 2.0 * x[1].copy()


def named_slices(a, x, y):
    inner, every = slice(1, -1), np.s_[::2]
    both = (slice(1, None), slice(None, -1))
    for k in range(2):
        part = slice(k, k + 2)
        x[part] *= y[part]
        a[k, inner] += y[inner]
    return np.sum(a[both] * a[1:, 1:]) + np.sum(y[every] ** 2) + np.sum(a[:, every]) * x[0]


def slice_bound_twice(x):
    part = slice(0, 1)
    x[part] *= 2.0
    part = slice(1, 3)
    x[part] *= 3.0


def slice_used_before(x):
    for k in range(3):
        if k > 0:
            x[part] *= 2.0  # noqa: F821
        part = slice(0, k)  # noqa: F841


def slice_passed(x):
    part = slice(0, 2)
    x[0] = np.sum(np.take(x, part))


def cases():
    # kernel
    for kernel in KERNELS:
        random = generator(7)
        given = 0.3 + 0.7 * random.random((3, 4)), np.array([0.6, 0.9, 1.2]), 0.5 + random.random(4)
        left = [g.copy() for g in given]
        kernel(*left)
        of = tuple(n for n, p, q in zip("axy", given, left) if not np.array_equal(p, q))
        yield Case(kernel, given, ("a", "x", "y"), (*of, "return"))
    # copy of a number
    yield Case(copy_of_a_number, (np.array([0.3, 0.7, 0.4]),), "x", "x")
    # named slices
    random = generator(3)
    yield Case(named_slices, (random.random((3, 4)), random.random(3), random.random(4)), ("a", "x", "y"),
        ("a", "x", "return"))
    for kernel in (slice_bound_twice, slice_used_before):
        yield Case(kernel, (np.ones(3),), "x", of=("x",))
    # slices refused
    yield Case(slice_passed, (np.ones(3),), of=None, refused=(
        "S201 at `np.take(x, part)`: a slice that is no subscript: write the slice where it is used: x[a:b]"))
