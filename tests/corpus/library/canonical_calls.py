"""What NumPy's functions and Python's mean where it is told by types or ranks: weights of several axes, joins of
matrices, sums of bools, conjugates of what is real, steps."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

random = generator(5)
A, X, Y = (0.2 + random.random(shape) for shape in ((3, 3, 3), (3, 3), 3))
MIXED = np.array([-1.0, 0.0, 2.0])


def weighted(a, x, y):
    """Weights of two axes, of one, of all."""
    first = np.average(a, axis=(0, 1), weights=x) * np.average(a, axis=(0, 2), weights=x)
    second = np.average(a, axis=-1, weights=y) * np.average(x, weights=x * x)
    return np.sum(first * y) + np.sum(second ** 2) + np.sum(np.average(a, weights=a ** 2, axis=(1, 2)) * y)


def joined(a, x, y):
    """Matrices one below the other."""
    rows = np.r_[x, a[0]]
    return np.sum(rows[:, :2] ** 2 * np.arange(12.0).reshape(6, 2)) + np.sum(
        np.r_[y, y[0], 0:2] ** 2 * np.arange(6.0)) + np.sum(np.c_[x, y][:, 2:] ** 2 * np.arange(6.0).reshape(3, 2))


def added(a, x, y):
    """From 0 on, as integers; numbers and arrays as they are."""
    m = y > 0.1
    s, t = sum((m[0], m[1])), sum([m[0], m[1]], 1)
    both = sum((m, m))
    return y[0] * s ** 2 + t * y[1] + np.sum(both * y ** 2) + sum((y[0], y[1])) ** 2 + np.sum(sum([x[0], x[1]], y) ** 2)


def alone(a, x, y):
    """The sum of one array is another one."""
    s = sum([y])
    s[0] = 5.0
    return np.sum(y ** 2) + np.sum(s * y)


def conjugated(a, x, y):
    """The method of a real array gives itself, the function a copy."""
    r, q, f = y.conj(), x.conjugate(), np.conj(x[0])
    r[0] = 5.0 * y[1]
    q[1, 1] *= 2.0
    f[0] *= 3.0
    return np.sum(y ** 2) + np.sum(r * y) + np.sum(x ** 2) + np.sum(f * x[0]) + x[0, 0].conj() * y[0]


def stepped(a, x, y):
    h = np.heaviside(MIXED, y) + np.heaviside(MIXED - 2.0, x[0])
    return np.sum(np.heaviside(MIXED, y * x[1]) * y) + np.sum(h * y) + np.heaviside(0.0, y[0] * y[1]) + np.max(
        np.heaviside(MIXED, 0.5) * y)


def along_others(a, x, y):
    return np.sum(np.average(a, axis=(1, 0), weights=x))


def along_all(a, x, y):
    return np.average(x, weights=y)


WHOLE = np.array([[1, 2, 3], [0, -1, 2], [3, 1, 1]])


def padded(a, x, n):
    """Widths that names stand for."""
    g = 3
    b, c = np.pad(x[0], n, mode="edge"), np.pad(x, ((n, n - 1), (0, g)), mode="edge")
    return np.sum(b ** 2 * np.arange(3.0 + 2 * n)) + np.sum(c ** 2 * np.arange(6.0)) + np.sum(
        np.pad(x, g, mode="wrap") ** 2) + np.sum(np.pad(x, ((n, 0), (0, 1))) * np.arange(4.0))


def whole(a, x, n):
    """Products of integers and of bools."""
    k = WHOLE * n
    m = k > 2
    y = np.sum(a, axis=0) * (k @ WHOLE) + x * np.dot(m, m) + np.inner(k, k[0]) * (m @ m[1])
    return np.sum(y) + x[0, 0] * np.dot(k[0], k[1]) + np.vdot(k[1], k[2]) * x[0, 1] + np.sum(x * np.inner(m[0], m[1]))


def shaped(a, x, n):
    """A shape in an expression; shifts that are added; options behind those for the result."""
    b = x * np.shape(x)[0] + np.roll(x, (1, 2)) * np.arange(3.0) + np.roll(x, (1, n), axis=1)
    c = np.zeros(3)
    np.max(x, 1, c)
    return np.sum(b ** 2 * x) + np.sum(np.sum(x, 0, None) ** 2 + c) + np.sum(np.var(x, 1, None, None, 1)) + np.sum(
        x.std(1, None, None, 1)) + np.mean(x, None, None) * np.sum(np.max(x, 1, None, True) * b + np.cumsum(x, 1, None))


def fewer(a, x, n):
    y = x.copy()
    np.fill_diagonal(y, x[0, :2])
    return np.sum(y * y)


def stacks(a, x, n):
    return np.sum(np.linalg.solve(a, a[None]))


def no_axis(a, x, n):
    return np.sum(np.max(a, axis=()))


def sizes_that_are_asked_for(a, x, n):
    wave = np.empty((2, np.size(x, 1)))
    wave[0, :] = x[0] * x[1] * np.size(x, axis=-1)
    wave[1, :] = x[0] * np.size(x)
    return np.sum(wave ** 2) * np.ndim(x) + np.sum(a) * np.size(a[0, 0, 0])


def of_either_kind(x):
    return abs(x[0, 0] - 1.0) + np.sum(abs(x - 0.7))


def cases():
    # kernel
    for kernel in (stepped, weighted, joined, added, alone, conjugated):
        yield Case(kernel, (A, X, Y), ("a", "x", "y"))
    # weights refused
    for kernel, part in (
            (along_others, "np.average(a, axis=(1, 0), weights=x)"),
            (along_all, "np.average(x, weights=y)")):
        yield Case(kernel, (A, X, Y), "x", refused=(
            f"S301 at `{part}`: "
            "no derivative rule for numpy.average: write it as a loop over the elements"))
    # of numbers
    for kernel in (whole, padded, shaped):
        yield Case(kernel, (A, X, 2), ("a", "x"))
    # sizes that do not fit
    for kernel in (fewer,):
        yield Case(kernel, (A, X, 2), "x", refused=(
            "S501 at `np.fill_diagonal(y, x[0, :2])`: np.fill_diagonal with fewer values than the diagonal "
            "has: held.shape[0] is 2, min(y.shape[0], y.shape[1]) is 3"))
    # refused
    for kernel, refused in (
            (stacks,
             "S301 at `np.linalg.solve(a, a[None])`: no derivative rule for numpy.linalg.solve: give both the "
             "same leading axes: stacks of as many matrices, or one matrix of two axes"),
            (no_axis,
             "S301 at `np.max(a, axis=())`: no derivative rule for numpy.max: write it as a loop over the elements")):
        yield Case(kernel, (A, X, 2), "a", refused=refused)
    # sizes that are asked for
    yield Case(sizes_that_are_asked_for, (A, X, 2), ("a", "x"))
    # abs of an array is numpys
    yield Case(of_either_kind, (X,), ("x",))
