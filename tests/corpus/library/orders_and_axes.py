"""Elements in the order of columns, axes that are added, exchanged or left out, several quantiles at once."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def columns_first(m, t):
    a = np.reshape(m, (2, 6), order="F")
    b = m.flatten("F") * np.ravel(m, order="F") + m.ravel(order="C")
    c = t.reshape(9, -1, order="F")[1:]
    d = np.reshape(m, -1, "F")[1:] * b[1:] + np.reshape(m, m.T.shape, order="F").flatten(order="F")[:-1]
    return np.sum(a ** 2 * np.arange(12.0).reshape(2, 6)) + np.sum(b * np.arange(12.0)) + np.sum(c ** 2) + np.sum(
        d ** 2)


def columns_of_nothing(m, t):
    e = m[:0]
    return np.sum(e.reshape(0, 3, order="F")) + np.sum(e.flatten("F")) + np.sum(m[:1, :1].ravel("F") ** 2)


def columns_backwards(m, t):
    """Of parts with negative steps, which are copied."""
    s = m[::-1, ::2]
    v = s.flatten("F")
    v[0] = 3.0 * v[1]
    w = s.T.reshape((3, 2), order="F")
    return np.sum(v ** 2 * np.arange(6.0)) + np.sum(w ** 3 * np.arange(6.0).reshape(3, 2))


def written_behind(m, t):
    r = np.rot90(m)
    m[0, 0] = 2.0
    return np.sum(r)


def flat_columns_written(m, t):
    v = m.ravel("F")
    v[0] = 2.0
    return np.sum(m)


def turned(m, t):
    a = np.rot90(t, axes=(1, 2)) * np.rot90(t, 3, (2, 1)) + np.rot90(t, 2, (-1, 1))
    b = np.rot90(t, -1, axes=(0, 2))[0] ** 2
    return np.sum(a ** 2 * np.arange(18.0).reshape(2, 3, 3)) + np.sum(b * np.arange(6.0).reshape(3, 2)) + np.sum(
        np.rot90(m, 1, (1, 0)) ** 2 * np.arange(12.0).reshape(4, 3)) + np.sum(np.rot90(t, 1, (2, 1))[0, 1] ** 3)


def diagonals(m, t):
    a, b = np.diagonal(m, 1, 1, 0), m.diagonal(axis1=-1, axis2=-2)
    return np.sum(a ** 2 * np.arange(a.size)) + np.sum(b ** 3 * np.arange(b.size)) + np.sum(m.diagonal(1, 0, 1) ** 2)


def three_axes(m, t):
    v = m[0]
    a, b = np.atleast_3d(v), np.atleast_3d(m)
    a[0, 1, 0] = 3.0 * a[0, 0, 0] ** 2
    m[1, 0] = 2.0 * m[1, 1]
    return np.sum(a ** 2 * np.arange(4.0)[:, None]) + np.sum(b[:, :, 0] * m) + np.sum(np.atleast_3d(t) ** 2) + np.sum(
        np.atleast_3d(m[0, 0]) ** 2) + np.sum(np.atleast_3d(m[:0]))


def left_out(m, t):
    a, b = t[:1, :, :1].squeeze(axis=(0, 2)), np.squeeze(t[None, None], (0, 1))
    a[0] = 3.0 * t[1, 1, 1]
    return np.sum(a ** 2) + np.sum(b ** 3 * np.arange(18.0).reshape(2, 3, 3)) + np.sum(np.diff(m, 6)) + np.sum(
        np.diff(m.ravel(), n=7) ** 2)


def known_axes(m, t):
    """Axes of length 1 by the form of what is squeezed."""
    v, s = m[0], 0.0
    for axis in range(1):
        s += np.sum(np.sum(m, axis=axis, keepdims=True).squeeze() ** 2 * np.arange(4.0))
    s += np.sum(np.squeeze(np.max(t, axis=(0, -1), keepdims=True)) ** 2 * np.arange(3.0))
    s += np.sum((m @ v[:, None]).squeeze() ** 2 * np.arange(3.0)) + np.sum((v[None] @ m.T).squeeze() ** 3)
    s += np.sum(np.squeeze(np.expand_dims(m, 0)) ** 2 * m) + np.sum(np.atleast_2d(v).squeeze() ** 2 * np.arange(4.0))
    a = m.reshape(1, 12).squeeze()
    a[0] = v[2] * a[1]
    return s + np.sum(m ** 2 * np.arange(12.0).reshape(3, 4))


def unknown_axes(m, t):
    return np.sum(m.squeeze() ** 2)


def more_axes(m, t):
    return np.sum(np.sum(m[:, :t.shape[0] - 1], axis=0, keepdims=True).squeeze() ** 2)


def made(m, t):
    b, k = np.ndarray((3, 2)), np.ndarray(4, dtype=int)
    b[...] = m[:, 1:3] * m[:, :2]
    k[:] = 2
    c = np.ndarray(m.shape[:1], float)
    c[:] = m[k[0]][:3]
    return np.sum(b ** 2) + np.sum(c ** 3) + np.sum(np.repeat(m[0, 0], 3) ** 2 * np.arange(3.0)) + np.sum(
        np.repeat(m[1, 1] > 0.0, 4) * m) + np.sum(np.repeat(m[0, 1], 0))


def several_quantiles(m, t):
    low, high = np.quantile(m[0], [0.25, 0.8])
    a = np.percentile(t, (10, 50.0, 100), axis=1)
    b = np.quantile(m, np.linspace(0.0, 1.0, 4))
    return low * high ** 2 + np.sum(a ** 2 * np.arange(18.0).reshape(3, 2, 3)) + np.sum(
        b ** 2 * np.arange(4.0)) + np.sum(
        np.quantile(m[:1, 0], [0.3, 0.9]) ** 2) + np.sum(np.quantile(m[::-1, ::-2], [0.0, 0.3], axis=-1) ** 3)


def at_levels(x, q):
    return np.sum(np.quantile(x, q) ** 2)


def axes_kept(m, t):
    """The middle along an axis that stays with length 1."""
    a = m - np.median(m, axis=1, keepdims=True)
    b = np.percentile(t, 30, axis=1, keepdims=True) * np.quantile(t, 0.3, axis=-1, keepdims=True)
    c = np.quantile(t[::-1], 0.6, axis=0, keepdims=True)
    d = np.median(m[0, ::-2], axis=0, keepdims=True) * m[0] + np.median(m[1:2], axis=0, keepdims=True)[0]
    return np.sum(a ** 2 * np.arange(4.0)) + np.sum(b ** 2) + np.sum(c ** 2 * t[0, 0]) + np.sum(d ** 2) + np.sum(
        np.median(t, axis=1, keepdims=True).squeeze() ** 2)


def repeated(z):
    return np.sum((np.repeat(z, 2, axis=1) ** 2).real[0]) + np.sum((np.repeat(z, [1, 0, 2, 3]) ** 3).imag) + np.sum(
        np.repeat(z[0, 0], 3).real ** 2) + np.sum((np.tile(z[0], (2, 1)) ** 2).imag) + np.sum(
        (np.rot90(z) * np.atleast_3d(z)[:, :, 0]).real) + np.sum((z[:1].squeeze() ** 2).imag)


def triangles_read(m, t):
    """Of what is not symmetric one triangle is read."""
    a = m[:, :3] + np.diag(np.array([1.0, 2.0, 4.0]))
    w, v = np.linalg.eigh(a, UPLO="L")
    low, _ = np.linalg.eigh(a, "L")
    return np.sum(w ** 2 * v[0] ** 2) + low[0] ** 2 + np.sum(np.linalg.eigvalsh(a, UPLO="U") ** 2 * np.arange(3.0)) + (
        np.linalg.eigvalsh(a, "L")[1] ** 3)


CASES = (columns_first, columns_of_nothing, columns_backwards, turned, diagonals, three_axes, left_out, known_axes,
         made,         several_quantiles, axes_kept, triangles_read)
_SHARED = ("an array is written that NumPy shares with another one, which is a view of it by a function: write into "
           "the array itself, or take a copy: np.copy(...)")


DIRECTIONS = np.array([[0, 1], [1, -1], [-1, 0]])


class Lattice:
    directions = np.array([[0, 1], [1, -1], [-1, 0]])

    def __init__(self, m):
        self.m = m

    def stream(self, k):
        return np.roll(self.m, self.directions[k], axis=(0, 1))


def shifts_of_a_row(m, t):
    lattice, s = Lattice(m), 0.0
    for k in range(3):
        s += np.sum(lattice.stream(k) * m[::-1]) * np.sum(np.roll(m, DIRECTIONS[k], axis=(1, 0)) ** 2 * m)
    return s


def taken_by_ranges(m, t):
    s = 0.0
    for axis in (0, 1):
        n = m.shape[axis]
        s += np.sum(np.take(m, range(1, n), axis=axis) * np.take(m, range(n - 1), axis=axis))
    return s


def cases():
    rng = generator(17)
    m, t = rng.random((3, 4)), rng.random((2, 3, 3))
    for kernel in CASES:
        yield Case(kernel, (m, t), ("m", "t"))
    for kernel in (columns_first, turned, three_axes, axes_kept):
        yield Case(kernel, (m.astype("float32"), t.astype("float32")), ("m", "t"))
    yield Case(at_levels, (m[0], np.array([0.2, 0.75])), ("x", "q"))
    yield Case(at_levels, (m[0, :1], np.zeros(0)), ("x", "q"))
    z = rng.random((2, 2)) + 1j * rng.random((2, 2))
    yield Case(repeated, (z,), ("z",))
    yield Case(unknown_axes, (m, t), refused="S301 at `m.squeeze()`: no derivative rule for numpy.squeeze: name the "
               "axis: np.squeeze(x, axis=0), or write x[0]")
    yield Case(more_axes, (m, t), refused=(
        "S501 at `np.sum(m[:, :t.shape[0] - 1], axis=0, keepdims=True).squeeze()`: np.squeeze without an axis leaves "
        "out every axis of length 1: sum_value.shape[1] is 1: name it"))
    yield Case(written_behind, (m, t), refused=f"S201 at `m[0, 0] = 2.0`: {_SHARED}")
    yield Case(flat_columns_written, (m, t), refused=f"S201 at `v[0] = 2.0`: {_SHARED}")
    for kernel in (shifts_of_a_row, taken_by_ranges):
        yield Case(kernel, (m, t), ("m",))
