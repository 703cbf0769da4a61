"""What a reduction along axes gives back to the elements that it was made of."""
from __future__ import annotations

import numpy as np


def spread(g, shape, axis=None, keepdims=False):
    """An array of this shape that holds along `axis` what a sum along it left: read-only, not copied.

    >>> spread(np.array([1.0, 2.0]), (2, 3), axis=1)
    array([[1., 1., 1.],
           [2., 2., 2.]])
    """
    if axis is not None and not keepdims:
        g = np.expand_dims(g, axis)
    return np.broadcast_to(g, shape)


def extreme_mask(x, y, axis=None, keepdims=False):
    """One at the first element along `axis` that equals the extreme `y`, or is nan as it is; zero elsewhere.

    >>> extreme_mask(np.array([[3.0, 1.0, 3.0]]), np.array([3.0]), axis=1)
    array([[1., 0., 0.]])
    """
    if axis is None and not keepdims:
        first = np.zeros(x.shape, x.dtype)
        if x.size:
            first.reshape(-1)[np.argmax(x == y if y == y else x != x)] = 1
        return first
    if not x.size:
        return np.zeros(x.shape, x.dtype)
    best = spread(y, x.shape, axis, keepdims)
    found = (x == best) | ((x != x) & (best != best))
    axes = tuple(range(x.ndim)) if axis is None else axis if isinstance(axis, tuple) else (axis,)
    axes = tuple(sorted(a % x.ndim for a in axes))
    kept = tuple(k for k in range(x.ndim) if k not in axes)
    moved = np.transpose(found, kept + axes)
    rows = moved.reshape(moved.shape[:len(kept)] + (-1,))
    first = np.zeros(rows.shape, x.dtype)
    np.put_along_axis(first, np.argmax(rows, axis=-1)[..., None], 1, axis=-1)
    return np.transpose(first.reshape(moved.shape), np.argsort(kept + axes))


def extreme_place(x, y):
    """The index of the first element that equals the extreme `y` of all, or is nan as it is.

    >>> tuple(map(int, extreme_place(np.array([[3.0, 1.0], [0.0, 3.0]]), 3.0)))
    (0, 0)
    """
    return np.unravel_index(np.argmax(x == y if y == y else x != x), x.shape)


def scattered(g, shape, places):
    """An array of zeros of this shape to which `g` was added at `places`, where one is named twice twice.

    >>> scattered(np.array([1.0, 2.0, 4.0]), (3,), np.s_[np.array([0, 2, 2])])
    array([1., 0., 6.])
    """
    found = np.zeros(shape, np.result_type(g, np.float64))      # rounded once, where it is stored
    np.add.at(found, places, g)
    return found


def strong_zero(factor, product, steep):
    """The product with a factor; where it is `steep`, for what it is multiplied with is infinite somewhere, zero where
    the factor is.

    >>> strong_zero(np.array([0.0, 2.0]), np.array([np.nan, np.inf]), True)
    array([ 0., inf])
    """
    return np.where(factor == 0.0, 0.0, product) if steep else product
