"""Functions of whole arrays, one small kernel for each."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


# -- a: (3, 4), x: (3,), y: (4,); what is returned is a number -------------------------------------------------------

def diff(a, x, y):
    return np.sum(np.diff(y) ** 2) + np.sum(np.diff(a, axis=0)[0] * y) + np.sum(np.diff(a * a, n=2) ** 3)


def concatenate(a, x, y):
    b = np.concatenate((x, y * y, x[1:]))
    c = np.concatenate([a, a * x[:, None]], axis=1)
    return np.sum(b[2:] * b[:-2]) + np.sum(c[:, 3:] ** 3) + np.sum(np.concatenate(([0.0, x[0]], y)) ** 2)


def stacks(a, x, y):
    b = np.stack((y, y * y))
    c = np.stack([x, a[:, 0] * x], axis=1)
    d = np.hstack((x, 2.0, y))
    e = np.vstack((a, y, b))
    f = np.column_stack((x, a))
    return np.sum(b[1] * y) + np.sum(c ** 3) + np.sum(d ** 2) + np.sum(e[1:] * e[:-1]) + np.sum(f[:, 1] * f[:, 0])


def appended(a, x, y):
    return np.sum(np.append(x, y[0]) ** 2) + np.sum(np.append(x * x, y) ** 3)


def axes_added_and_dropped(a, x, y):
    b = np.expand_dims(x, 1) * a
    c = np.expand_dims(y, axis=0)
    return np.sum(b * c) + np.sum(np.squeeze(c, axis=0) ** 3)


def axes_swapped(a, x, y):
    b = np.swapaxes(a, 0, 1) * x
    c = np.moveaxis(a, 0, -1)
    return np.sum(b * c * y[:, None])


def axes_of_three(b, x):
    c = np.transpose(b, (2, 0, 1)) * x[:, None, None]
    d = b.transpose(1, 2, 0) * x[None, :, None]
    e = np.swapaxes(b, 0, 2) ** 2 * x[:, None, None]
    return np.sum(c * c) + np.sum(d ** 3) + np.sum(e)


def tiled(a, x, y):
    b = np.tile(x, 2)
    c = np.tile(a, (2, 3))
    d = np.tile(y, (2, 1))
    return np.sum(b[1:] * b[:-1]) + np.sum(c[1:, 2:] * c[:-1, :-2]) + np.sum(d[0] * d[1])


def repeated(a, x, y):
    b = np.repeat(x, 3)
    c = np.repeat(a, 2, axis=0)
    d = np.repeat(a, 2, axis=1)
    return np.sum(b[1:] * b[:-1]) + np.sum(c[1:] * c[:-1]) + np.sum(d[:, 2:] ** 3) + np.sum(np.repeat(a, 2) ** 2)


def padded(a, x, y):
    b = np.pad(x, 2) * np.pad(x, (1, 3), mode="constant", constant_values=2.0)
    c = np.pad(a, 1, mode="edge")
    d = np.pad(a, ((1, 2), (0, 3)), mode="wrap")
    return np.sum(b) + np.sum(c[1:, :] * c[:-1, :]) + np.sum(d[1:] * d[:-1])


def mirrored(a, x, y):
    b = np.pad(y, (2, 1), mode="reflect")
    c = np.pad(a, ((0, 1), (2, 0)), mode="symmetric")
    return np.sum(b[1:] * b[:-1] ** 2) + np.sum(c[:, 1:] * c[:, :-1])


def diagonals(a, x, y):
    b = np.diag(x) + 0.5 * np.diag(y, -1)[:3, :3]
    return np.sum(b * b) + np.sum(np.diag(a) ** 2) + np.sum(np.diag(a, k=1) ** 3) + np.sum(np.diagonal(a) * x)


def triangles(a, x, y):
    b = np.tril(a) * y + np.triu(a, 1) ** 2 + np.tril(a, -1) ** 3
    return np.sum(b * b) + np.trace(a) * x[0] + np.trace(a, 1) ** 2


def identity_matrices(a, x, y):
    m = np.eye(3) * x + 0.5 * np.eye(3, k=1)
    b = m @ a + np.identity(3)[:, :1]
    return np.sum(b * b) + np.sum(np.eye(3, 4) * a)


def ranges(a, x, y):
    b = np.linspace(x[0], y[1], 4) * y
    c = np.linspace(0.0, 1.0, 3, endpoint=False)
    d = np.arange(4) * y + np.arange(0.0, 1.0, 0.25)
    e = np.arange(2, 8, 2) * x
    return np.sum(b * b) + np.sum(c * x) + np.sum(d * d) + np.sum(e ** 2)


def spreads(a, x, y):
    b = np.var(a, axis=0) * y
    return np.var(x) + np.var(y, ddof=1) + np.sum(b) + np.sum(a.var(axis=1, keepdims=True) * a) + np.var(a)


def deviations(a, x, y):
    z = (a - np.mean(a, axis=0)) / np.std(a, axis=0, ddof=1)
    return np.sum(z ** 3 * y) + x.std() + np.std(a) + np.sum(np.std(a, axis=1) * x)


def norms(a, x, y):
    b = np.linalg.norm(a, axis=1) * x
    c = a / np.linalg.norm(a, axis=0, keepdims=True)
    return np.linalg.norm(x) * np.linalg.norm(a) + np.sum(b) + np.sum(c * y) + np.linalg.norm(y - 0.7, 1) + \
        np.linalg.norm(y, np.inf)


def products_of_elements(a, x, y):
    return np.prod(x) * y[0] + np.prod(a) + np.sum(np.prod(a, axis=0) * y) + np.sum(a.prod(axis=1, keepdims=True) * a)


def running(a, x, y):
    b = np.cumsum(x)
    c = np.cumsum(a, axis=1) * np.cumprod(a, axis=0)
    d = y.cumprod()
    return np.sum(b * x) + np.sum(c * c) + np.sum(d * y) + np.sum(np.cumsum(a) ** 2) + np.sum(np.cumprod(a) ** 2)


def averages(a, x, y):
    return np.average(x) + np.sum(np.average(a, axis=0) * y) + np.average(x, weights=x * x) + np.sum(
        np.average(a, axis=1, weights=y) * x)


def inner_products(a, x, y):
    return np.vdot(x, x * x) + np.vdot(a, a) + np.inner(y, y) + np.sum(np.inner(a, y) * x) + np.sum(
        np.inner(a, a) * x) + np.sum(np.inner(y, a))


def integrals(a, x, y):
    t = np.cumsum(y)
    return np.trapezoid(y) + np.trapezoid(y * y, dx=x[0]) + np.trapezoid(y, t) + np.sum(
        np.trapezoid(a, axis=0) * y) + np.sum(np.trapezoid(a, t) * x)


def gradients(a, x, y):
    t = np.cumsum(y)
    b = np.gradient(a, axis=1) + np.gradient(a, x[0], axis=0)
    return np.sum(np.gradient(y) ** 2) + np.sum(np.gradient(y, x[1]) ** 3) + np.sum(b * b) + np.sum(
        np.gradient(y * y, t) * y) + np.sum(np.gradient(a, t, axis=1) ** 2)


def convolved(a, x, y):
    b = np.convolve(y, x)
    c = np.convolve(x, y, mode="same")
    d = np.convolve(y, x, "valid")
    return np.sum(b * b) + np.sum(c ** 3) + np.sum(d * d)


def interpolated(a, x, y):
    t = np.cumsum(y)
    b = np.interp(2.0 * x, t, a[0])
    return np.sum(b * b) + np.interp(x[0] * 2.5, t, y) + np.interp(0.01 * x[0], t, y) * np.interp(9.0, t, y)


def questions(a, x, y):
    k = np.argmax(y)
    m = np.argmin(x)
    s = y[k] * x[m]
    if np.any(x > 1.0) and np.all(y > 0.0):
        s *= np.count_nonzero(a > 0.5)
    return s + np.sum(a)


def spread_out(a, x, y):
    b = np.broadcast_to(x[:, None], a.shape)
    c = np.broadcast_to(y, (2, 4))
    return np.sum(b * a) + np.sum(c[0] * c[1])


def questions_along_axes(a, x, y):
    b = np.where(np.any(a > 0.9, axis=1), x, x * x)
    c = np.where(np.all(a > 0.31, axis=0), y, y * y)
    k = x.argmax()
    return np.sum(b) + np.sum(c) + np.sum(np.count_nonzero(a > 0.6, axis=1) * x ** 2) + x[k] * a.any()


def in_place_and_in_loops(a, x, y):
    for k in range(3):
        x[1:] += np.diff(x) * a[k, 0]
        y[:] = np.cumsum(y) / np.sum(y)
        row = np.concatenate((a[k, 1:], a[k, :1]))
        a[k] *= row * np.linalg.norm(row)
        x[k] = np.var(row) + np.trapezoid(row)
    return np.sum(a) + np.sum(x) + np.sum(y * y)


def arguments(kernel):
    random = generator(7)
    if kernel is axes_of_three:
        return 0.3 + random.random((2, 3, 4)), 0.5 + random.random(4)
    return 0.3 + 0.7 * random.random((3, 4)), 0.5 + random.random(3), 0.5 + random.random(4)


def zero_factors(x):
    return np.prod(x) + np.sum(np.cumprod(x))


def ends(x):
    return np.sum(np.diff(x)) + np.sum(np.cumsum(x)) + np.prod(x) + np.var(x) + np.sum(np.pad(x, 1, mode="edge")) + \
        np.sum(np.concatenate((x, x))) + np.sum(np.repeat(x, 2)) + np.sum(np.tile(x, 2)) + np.trapezoid(x)


def unknown_option(x):
    return np.sum(np.cumsum(x, dtype=np.float32))


def unknown_mode(x):
    return np.sum(np.pad(x, 1, mode="median"))


def fractional(x):
    return np.linalg.norm(np.diag(x), 0.5)


def along(x):
    return np.sum(x) * np.sum(np.argmax(np.diag(x), axis=0, keepdims=True))


def diagonal_read_in_the_next_iteration(a, x):
    d = np.diag(a)
    s = 0.0
    for k in range(2):
        s += d[k] * x[k]
        a[1, 1] = x[0]
    return s


def made_matrix_written(x):
    m = np.diag(x)
    m[0, 1] = x[0] * x[1]
    c = (2.0 * m).reshape(-1)
    c[0] *= c[1]
    return np.sum(c * c)


def total_of_squares(c):
    s = 0.0
    for k in range(c.shape[0]):
        s += c[k, 0] ** 2
    return s


def view_read_by_a_helper(a):
    c = a.T
    return total_of_squares(c) * np.sum(c)


def cases():
    for kernel in (diff, concatenate, stacks, appended, axes_added_and_dropped, axes_swapped, axes_of_three, tiled,
                   repeated, padded, mirrored, diagonals, triangles, identity_matrices, ranges, spreads, deviations,
                   norms, products_of_elements, running, averages, inner_products, integrals, gradients, convolved,
                   interpolated, questions, spread_out, questions_along_axes, in_place_and_in_loops):
        yield Case(kernel, arguments(kernel), kernel.__code__.co_varnames[:kernel.__code__.co_argcount])
    # where formulas of calculus divide by zero
    for x in (np.array([2.0, 0.0, 3.0, 5.0]), np.array([2.0, 0.0, 3.0, 0.0])):
        yield Case(zero_factors, (x,), ("x",))
    yield Case(ends, (np.array([1.5]),), ("x",))
    # what is no view may be written, a view may be read by a helper
    yield Case(made_matrix_written, (np.array([0.5, 0.7, 0.9]),), ("x",))
    yield Case(view_read_by_a_helper, (np.array([[0.5, 0.7, 0.9]]),), ("a",))
    for kernel, refused in (
            (unknown_option,
             "S301 at `np.cumsum(x, dtype=np.float32)`: no derivative rule for numpy.cumsum with dtype=: write it as "
             "a loop over the elements"),
            (unknown_mode,
             'S301 at `np.pad(x, 1, mode="median")`: no derivative rule for numpy.pad: write it as a loop over the '
             "elements"),
            (fractional,
             "S301 at `np.linalg.norm(np.diag(x), 0.5)`: no derivative rule for numpy.linalg.norm: write it as a "
             "loop over the elements"),
            (along,
             "S301 at `np.argmax(np.diag(x), axis=0, keepdims=True)`: no derivative rule for numpy.argmax with more "
             "than the array: write it as a loop over the elements")):
        yield Case(kernel, (np.arange(3.0),), refused=refused)
    # a view that would be a copy
    yield Case(diagonal_read_in_the_next_iteration, (np.ones((3, 3)), np.ones(3)), refused=(
            "S201 at `a[1, 1] = x[0]`: an array is written that NumPy shares with another one, which is a view of it "
            "by a function: write into the array itself, or take a copy: np.copy(...)"))
