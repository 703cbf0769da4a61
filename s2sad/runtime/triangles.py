"""Systems with triangular and banded matrices, as `scipy.linalg` solves them, and their derivatives."""
from __future__ import annotations

import numpy as np


def solve_triangular(a, b, trans=0, lower=False, unit=False):
    """`scipy.linalg.solve_triangular(a, b, trans, lower, unit_diagonal=unit)`.

    >>> solve_triangular(np.array([[2.0, 0.0], [1.0, 4.0]]), np.array([2.0, 9.0]), 0, True, False)
    array([1., 2.])
    """
    n = a.shape[0]
    x = b.copy()
    forward = lower == (trans == 0)
    for step in range(n):
        i = step if forward else n - 1 - step
        if not unit:
            if a[i, i] == 0.0:
                raise np.linalg.LinAlgError("a triangular matrix with a zero on its diagonal")
            x[i] /= a[i, i]
        for j in range(i + 1 if forward else 0, n if forward else i):
            x[j] -= (a[j, i] if trans == 0 else a[i, j]) * x[i]
    return x


def triangle_gain(s, y, trans, lower, unit):
    """What the triangle gains of a solution `y` where its right side gains `s`.

    >>> triangle_gain(np.array([1.0, 2.0]), np.array([3.0, 4.0]), 0, True, False)
    array([[-3.,  0.],
           [-6., -8.]])
    """
    n = s.shape[0]
    left, right = s.reshape((n, -1)), y.reshape((n, -1))
    gain = -(left @ right.T) if trans == 0 else -(right @ left.T)
    return triangle(gain, lower, unit)


def triangle(a, lower, unit):
    """The triangle that is read of a matrix, without its diagonal where that is taken for ones.

    >>> triangle(np.ones((2, 2)), True, False)
    array([[1., 0.],
           [1., 1.]])
    """
    below = 1 if unit else 0
    return np.tril(a, -below) if lower else np.triu(a, below)


def triangle_times(a, y, trans, lower, unit):
    """The triangle that is read of `a`, or its transpose, times `y`.

    >>> triangle_times(np.ones((2, 2)), np.array([3.0, 4.0]), 0, True, False)
    array([3., 7.])
    """
    read = triangle(a, lower, unit)
    return read @ y if trans == 0 else read.T @ y


def solve_banded(bands, b, lower, upper):
    """`scipy.linalg.solve_banded((lower, upper), bands, b)`: by elimination with row exchanges.

    >>> solve_banded(np.array([[0.0, 1.0], [2.0, 4.0], [2.0, 0.0]]), np.array([4.0, 10.0]), 1, 1)
    array([1., 2.])
    """
    n = bands.shape[1]
    if bands.shape[0] != lower + upper + 1 or b.shape[0] != n:
        raise ValueError("bands and right side that do not fit the numbers of diagonals")
    width = 2 * lower + upper + 1
    rows = np.zeros((n, width), bands.dtype)  # row i from column i - lower on
    for i in range(n):
        for j in range(max(0, i - lower), min(n, i + upper + 1)):
            rows[i, j - i + lower] = bands[upper + i - j, j]
    x = b.copy()
    for k in range(n):
        last = min(n, k + lower + 1)
        found = k
        for i in range(k + 1, last):
            if abs(rows[i, k - i + lower]) > abs(rows[found, k - found + lower]):
                found = i
        if rows[found, k - found + lower] == 0.0:
            raise np.linalg.LinAlgError("singular matrix")
        stop = min(n, k + lower + upper + 1)
        if found != k:
            for j in range(k, stop):
                held = rows[k, j - k + lower]
                rows[k, j - k + lower] = rows[found, j - found + lower]
                rows[found, j - found + lower] = held
            row = x[k:k + 1].copy()
            x[k] = x[found]
            x[found] = row[0]
        for i in range(k + 1, last):
            factor = rows[i, k - i + lower] / rows[k, lower]
            if factor != 0.0:
                for j in range(k, stop):
                    rows[i, j - i + lower] -= factor * rows[k, j - k + lower]
                x[i] -= factor * x[k]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, min(n, i + lower + upper + 1)):
            x[i] -= rows[i, j - i + lower] * x[j]
        x[i] /= rows[i, lower]
    return x


def bands_transposed(bands, lower, upper):
    """The bands of the transpose, with `upper` diagonals below and `lower` above.

    >>> bands_transposed(np.array([[0.0, 1.0], [2.0, 4.0]]), 0, 1)
    array([[2., 4.],
           [1., 0.]])
    """
    n = bands.shape[1]
    made = np.zeros_like(bands)
    for i in range(n):
        for j in range(max(0, i - lower), min(n, i + upper + 1)):
            made[lower + j - i, i] = bands[upper + i - j, j]
    return made


def bands_gain(bands, s, y, lower, upper):
    """What the bands gain of a solution `y` where its right side gains `s`.

    >>> bands_gain(np.zeros((2, 2)), np.array([1.0, 2.0]), np.array([3.0, 4.0]), 0, 1)
    array([[ 0., -4.],
           [-3., -8.]])
    """
    n = bands.shape[1]
    left, right = s.reshape((n, -1)), y.reshape((n, -1))
    made = np.zeros_like(bands)
    for i in range(n):
        for j in range(max(0, i - lower), min(n, i + upper + 1)):
            for k in range(left.shape[1]):
                made[upper + i - j, j] -= left[i, k] * right[j, k]
    return made


def bands_times(bands, y, lower, upper):
    """The matrix with these bands times `y`.

    >>> bands_times(np.array([[0.0, 1.0], [2.0, 4.0]]), np.array([3.0, 4.0]), 0, 1)
    array([10., 16.])
    """
    n = bands.shape[1]
    made = np.zeros_like(y)
    for i in range(n):
        for j in range(max(0, i - lower), min(n, i + upper + 1)):
            made[i] += bands[upper + i - j, j] * y[j]
    return made
