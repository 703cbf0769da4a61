"""Functions that convert, count up and put in order: integers of few bits, masks, dtypes, kinds of orders."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

random = generator(5)
X, A = 0.2 + random.random(5), 0.2 + random.random((3, 4))
FEW, SMALL = np.array([1, 2, -3, 0, 4], dtype=np.int32), np.array([200, 100, 3, 4, 250], dtype=np.uint8)
TIES = np.array([1, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1])


def converted(x, a, k, u):
    w = u.astype(np.int64)
    return np.sum((w + w) * x) + np.sum(u.astype(float) * x) + np.sum(k.astype("float64") ** 2 * x) + np.sum(
        k.astype(int) * x)


def counted_up(x, a, k, u):
    """Sums and products of integers and of masks."""
    m = a > 0.5
    both = np.cumsum(m, axis=1) * np.cumsum(a, axis=0) + np.prod(m, axis=0) * a
    return np.sum(np.cumsum(k) * x) + np.prod(k[:3]) * x[0] + np.sum(np.cumsum(x > 0.5) * x) + np.sum(both) + np.sum(
        np.cumprod(k - 5) * x) + np.prod(m) * a[0, 0] + np.sum(np.cumsum(m)[:4] * a)


def made(x, a, k, u):
    """Arrays of numbers in a dtype; every element of several arrays; what is no number."""
    n = x.size
    ramp = np.arange(n, dtype=float) + np.arange(1, 6, dtype=np.float64) + np.arange(0, 5, 1, int)
    eyes = np.eye(3, 4, dtype=int) + np.eye(3, 4, k=1) * np.eye(3, 4, 1, bool)
    logs = np.nan_to_num(np.log(x - 0.5)) + np.nan_to_num(np.log(x * 0.0), neginf=2.0) + np.nan_to_num(
        np.where(x > 0.5, x, np.nan), nan=0.5)
    return np.sum(ramp * x) + np.sum(eyes * a) + np.sum(np.identity(5, dtype=int) * x) + np.sum(logs * x) + np.sum(
        np.concatenate((a, x), axis=None) ** 2 * np.arange(17.0)) + np.sum(np.fliplr(a) * np.flipud(a) ** 2 * x[:4])


def ordered(x, a, k, u):
    """Equal numbers keep their order where that is asked for."""
    w, o = np.arange(24.0) ** 2, np.argsort(a, axis=1, kind="stable")
    s = np.sum(w[np.argsort(TIES, kind="stable")] * np.arange(24.0)) - np.sum(
        w[np.argsort(TIES, stable=True)] * np.arange(24.0, 0.0, -1.0))
    return x[0] * s / 1e4 + np.sum(np.sort(a, 1, "stable") * np.arange(4.0)) + np.sum(
        np.take_along_axis(a, o, axis=1) ** 2 * np.arange(4.0)) + np.sum(
        x[x.argsort(kind="quicksort")] * np.arange(5.0))


def squeezed(x, a, k, u):
    """The axes that are written, or an argument's."""
    b = np.squeeze(x[:, None]) * np.squeeze(x[None, :, None])
    return np.sum(b * x[None].squeeze()) + np.sum(np.squeeze(k) ** 2 * np.arange(4.0))


def squeezed_number(x):
    return np.sum(np.squeeze(x[:, None]))


def squeezed_rows(x, n):
    rows = np.ones((n, 1)) * x[0]
    return np.sum(np.squeeze(rows))


def out_of_range(x):
    return np.sum(np.flip(x, axis=1))


def by_an_array(x):
    return np.sum(np.roll(x, FEW[:2]) * x)


def of_unsigned(x):
    return np.sum(x * np.cumsum(SMALL))


def the_same_array(x):
    """What has the dtype already is converted into itself, so that a store shows in both; elsewhere it is a copy."""
    y, z = np.float64(x), np.double(x[::2])
    y[0] = y[1] * y[4]
    z *= 2.0
    return np.sum(x * x * np.arange(1.0, 6.0))


def converted_in_expressions(x, y):
    return np.sum(np.float64(x[1:]) * y[1:]) + np.max(np.float64(x) * y) + np.dot(np.float64(x), np.float64(y))


def converted_operand(x, y):
    return np.float64(x) * y


def numbers_as_methods(x, y):
    s = x.sum().astype(float).item() ** 2
    for i in range(x.shape[0]):
        v = np.sin(x[i]).astype(np.float64)
        s += v * y[i].astype(complex).real + np.abs(y[i].astype("complex128") * (1.0 + 2.0j))
    return s * x[(x[0] * 3.0).astype(int) % 2] * y.mean().astype(x.dtype)


def lists_of_numbers(x, a):
    xs, rows = x.tolist(), a.tolist()
    xs.append(x[0] * 2.0)
    x[0] = 5.0                      # the list holds what was there
    rows[0][1] = xs[1] * xs[2]
    s = sum(xs) * x[1].tolist() * x.sum().tolist()
    for k, row in enumerate(rows):
        for v in row:
            s += k * v * v + v
    for v in (x * x).tolist():
        s += v ** 2
    return s


def lists_of_rows(x):
    return sum(v * v for row in np.outer(x, x).tolist() for v in row)


def cases():
    single = np.float32(X)
    yield Case(the_same_array, (X,), "x")
    yield Case(lists_of_numbers, (X, A), ("x", "a"), ("x", "return"))
    yield Case(lists_of_rows, (X,), "x")
    yield Case(numbers_as_methods, (X, X + 1.0), ("x", "y"))
    for kernel in (converted_in_expressions, converted_operand):
        yield Case(kernel, (X, X), ("x", "y"))
        yield Case(kernel, (single, X), "x")
    yield Case(squeezed, (X, A, 1.0 + A[:1], SMALL), ("x", "k"))
    yield Case(squeezed_number, (X[:1],), "x")
    yield Case(squeezed_rows, (X, 1), refused=(
            "S501 at `np.squeeze(rows)`: np.squeeze without an axis leaves out every axis of length 1: rows.shape[0] "
            "is 1: name it"))
    for kernel in (converted, ordered, counted_up, made):
        yield Case(kernel, (X, A, FEW, SMALL), ("x", "a"))
    for kernel, refused in (
            (out_of_range,
             "S301 at `np.flip(x, axis=1)`: no derivative rule for numpy.flip: write it as a loop over the elements"),
            (by_an_array,
             "S301 at `np.roll(x, FEW[:2])`: no derivative rule for numpy.roll: write it as a loop over the elements"),
            (of_unsigned,
             "S301 at `np.cumsum(SMALL)`: no derivative rule for numpy.cumsum: write it as a loop over the elements")):
        yield Case(kernel, (X,), refused=refused)
