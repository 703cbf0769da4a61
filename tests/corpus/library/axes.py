"""Axes and other options that names stand for: known before types are, or refused; one axis for another is a wrong
gradient."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

ROWS, KEEP = 1, True


def along(a, axis=0):
    return np.sum(a * np.roll(a, 1, axis=axis), axis)


def along_rows(a, axis):
    return np.max(np.cumsum(a, axis=axis) ** 2)


def slope(a, axis):
    return 0.5 * (np.roll(a, -1, axis=axis) - np.roll(a, 1, axis))


def energy(a, axis):
    return np.sum(slope(a, axis) ** 2)


def both_axes(a, b):
    """One helper for each axis that it is called with."""
    total = np.sum(slope(a, 0) * slope(b, 1) + slope(a * b, 0)) + energy(a, 1) + energy(b, axis=0)
    for d in range(2):
        if d < 2:
            total += energy(a * b, d) * (1 + d)
        b = slope(b, axis=d)
    for d in (1, -2):
        b = b + slope(a, d) * d
    return total + np.sum(b * a)


def counters(a, b):
    """The counter of a short loop, and a name for it."""
    total = 0.0
    for d in range(2):
        total += np.sum(b * np.roll(a, 1, axis=d) ** 2) + np.sum(np.roll(b, -1, d) * np.flip(a, axis=d))
    for axis in (1, 0):
        if total < 0.0:
            break
        total += np.sum(np.sum(a * b, axis) ** 2)
    for k, (axis, weight) in enumerate(((0, 2.0), (1, 3.0))):
        total += (k + weight) * np.sum(np.diff(a, axis=axis) ** 2)
    return total + sum(np.sum(np.max(b, axis=d) ** 2) for d in range(2))


def bound_once(a, b):
    """A local name, one of several, a module's."""
    axis, last, mode = 1, -1, "edge"
    other, both = 1 - axis, (0, axis)
    c = np.roll(b, 1, axis=axis) + b.cumsum(other) + np.flip(a, axis=last) + np.roll(a, (1, 2), axis=both)
    return np.sum(np.mean(c * a, axis=ROWS, keepdims=KEEP) * b) + np.sum(
        c.max(last) ** 2) + np.sum(np.pad(a[0], 2, mode=mode) ** 2) + np.sum(np.expand_dims(c[0], other) * a[0])


def helpers(a, b):
    return np.sum(along(a) ** 2) + np.sum(along(b) * a[0]) + along_rows(a * b, axis=1)


def of_an_argument(a, axis):
    return np.sum(np.roll(a, 1, axis=axis) * a)


def bound_twice(a, axis):
    d = 0
    if axis > 0:
        d = 1
    return np.sum(a * np.flip(a, axis=d))


def long_loop(a, axis):
    total = 0.0
    for d in range(axis):
        total += np.sum(np.sum(a, axis=d) ** 2)
    return total


def of_a_helper(a, axis):
    return np.sum(slope(a, axis) ** 2) + np.sum(slope(a, 1) ** 2)


def cases():
    random = generator(3)
    given = 0.2 + random.random((3, 4)), random.random((3, 4))
    for kernel in (counters, bound_once, helpers, both_axes):
        yield Case(kernel, given, ("a", "b"))
    for kernel in (of_an_argument, long_loop, of_a_helper):
        yield Case(kernel, (given[0], 1), ("a",))
    yield Case(bound_twice, (np.ones((2, 3)), 1), "a", refused=(
        "S301 at `d`: the axis of numpy.flip must be a number that is written in the kernel: write it, or a name that "
        "is bound once, to a number: np.sum(x, axis=1)"))
