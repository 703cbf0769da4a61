"""Discrete Fourier transforms along one axis, and their adjoints under the inner product Re(conj(a) b).

Compiled code calls these through the interpreter: Numba has no transforms of its own.
"""
from __future__ import annotations

import numpy as np


def fft(x, n, axis, norm):
    """`np.fft.fft`."""
    return np.fft.fft(x, n, axis, norm)


def ifft(x, n, axis, norm):
    """`np.fft.ifft`."""
    return np.fft.ifft(x, n, axis, norm)


def rfft(x, n, axis, norm):
    """`np.fft.rfft`."""
    return np.fft.rfft(x, n, axis, norm)


def irfft(x, n, axis, norm):
    """`np.fft.irfft`."""
    return np.fft.irfft(x, n, axis, norm)


def opposite(norm):
    """The norm that scales the inverse transform as this one scales the transform.

    >>> opposite(None), opposite("ortho"), opposite("forward")
    ('forward', 'ortho', 'backward')
    """
    if norm == "ortho":
        return norm
    return "backward" if norm == "forward" else "forward"


def fitted(x, size, axis):
    """An array with `size` elements along an axis: the first ones, or all of them and zeros behind.

    >>> fitted(np.array([1.0, 2.0]), 3, 0), fitted(np.array([1.0, 2.0]), 1, 0)
    (array([1., 2., 0.]), array([1.]))
    """
    known = min(size, x.shape[axis])
    rows = np.moveaxis(x, axis, 0)
    made = np.zeros((size, *rows.shape[1:]), x.dtype)
    made[:known] = rows[:known]
    return np.moveaxis(made, 0, axis)


def ends(g, n, axis, inside):
    """The half spectrum of a signal of n numbers with what stands there twice, all but the ends, times `inside`."""
    rows = np.moveaxis(np.array(g), axis, 0)
    rows[1:(n + 1) // 2] *= inside
    return np.moveaxis(rows, 0, axis)


def fft_adjoint(g, size, axis, norm):
    """What the `size` elements along an axis gain from those of their transform, as many as it was asked for.

    >>> fft_adjoint(np.array([1.0, 1.0]), 3, 0, None).tolist()
    [(2+0j), 0j, 0j]
    """
    return fitted(np.fft.ifft(g, axis=axis, norm=opposite(norm)), size, axis)


def ifft_adjoint(g, size, axis, norm):
    """As `fft_adjoint`, of the inverse transform."""
    return fitted(np.fft.fft(g, axis=axis, norm=opposite(norm)), size, axis)


def rfft_adjoint(g, n, size, axis, norm):
    """What `size` real elements gain from the half spectrum of the first n of them (None: of all).

    >>> rfft_adjoint(np.array([1.0, 0.0]), None, 3, 0, None).tolist()
    [1.0, 1.0, 1.0]
    """
    n = size if n is None else n
    return fitted(np.fft.irfft(ends(g, n, axis, 0.5), n, axis, opposite(norm)), size, axis)


def irfft_adjoint(g, size, axis, norm):
    """What the `size` elements of a half spectrum gain from the real signal that it stands for.

    >>> irfft_adjoint(np.array([1.0, 0.0, 0.0]), 2, 0, "forward").tolist()
    [(1+0j), (2+0j)]
    """
    half = ends(np.fft.rfft(g, axis=axis, norm=opposite(norm)), g.shape[axis], axis, 2.0)
    return fitted(half, size, axis)
