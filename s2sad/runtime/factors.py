"""A matrix factored once, for several solutions: its triangles with the pivots in a last row.

The shadow of the factors is the shadow of the matrix that they stand for, with a last row of zeros.
"""
from __future__ import annotations

import numpy as np


def factored(a):
    """The triangles L - I + U of a square matrix with its rows exchanged, and below them the row
    exchanged with each (G. Golub, C. Van Loan, Matrix Computations, 3.2 and 3.4, in panels of
    columns).

    >>> factored(np.array([[1.0, 2.0], [2.0, 2.0]]))
    array([[2. , 2. ],
           [0.5, 1. ],
           [1. , 1. ]])
    """
    n = a.shape[0]
    if n != a.shape[1]:
        raise ValueError("a matrix to solve with must be square")
    f = np.zeros((n + 1, n), a.dtype)
    f[:n] = a
    for first in range(0, n, 16):
        stop = min(first + 16, n)
        factor_panel(f, n, first, stop)
        for k in range(first, stop):
            for i in range(k + 1, stop):
                take_row(f, i, k, stop, n)
        update_rest(f, n, first, stop)
    return f


def factor_panel(f, n, first, stop):
    """The columns of one panel, rows exchanged in all columns.

    >>> f = np.array([[1.0, 2.0], [2.0, 2.0], [0.0, 0.0]])
    >>> factor_panel(f, 2, 0, 1)
    >>> f
    array([[2. , 2. ],
           [0.5, 2. ],
           [1. , 0. ]])
    """
    for k in range(first, stop):
        found = k
        for i in range(k + 1, n):
            if abs(f[i, k]) > abs(f[found, k]):
                found = i
        f[n, k] = found
        if found != k:
            for j in range(n):
                held = f[k, j]
                f[k, j] = f[found, j]
                f[found, j] = held
        if f[k, k] == 0.0:
            raise np.linalg.LinAlgError("Singular matrix")
        for i in range(k + 1, n):
            if f[i, k] != 0.0:
                f[i, k] /= f[k, k]
                take_row(f, i, k, k + 1, stop)


def update_rest(f, n, first, stop):
    """Takes a panel's part from the rows and columns behind it: by rows where few have one.

    >>> f = np.array([[2.0, 2.0], [0.5, 2.0], [1.0, 0.0]])
    >>> update_rest(f, 2, 0, 1)
    >>> f[1]
    array([0.5, 1. ])
    """
    rows = 0
    for i in range(stop, n):
        for k in range(first, stop):
            if f[i, k] != 0.0:
                rows += 1
                break
    if 2 * rows > n - stop and n - stop > 32:
        above = f[first:stop, stop:].copy()
        for i in range(stop, n, 32):  # a few rows at a time: no large array is made
            end = min(i + 32, n)
            f[i:end, stop:] -= f[i:end, first:stop].copy() @ above
        return
    for i in range(stop, n):
        for k in range(first, stop):
            take_row(f, i, k, stop, n)


def take_row(f, i, k, start, stop):
    """Takes a multiple of row k from row i, in columns from start to stop.

    >>> f = np.array([[2.0, 2.0], [0.5, 2.0]])
    >>> take_row(f, 1, 0, 1, 2)
    >>> f[1]
    array([0.5, 1. ])
    """
    factor = f[i, k]
    if factor != 0.0:
        for j in range(start, stop):
            f[i, j] -= factor * f[k, j]


def solved(f, b):
    """The solution for a matrix that has been factored, `np.linalg.solve(a, b)`.

    >>> solved(factored(np.array([[1.0, 2.0], [2.0, 2.0]])), np.array([3.0, 4.0]))
    array([1., 1.])
    """
    n = f.shape[1]
    x = b.copy()
    for k in range(n):
        found = int(f[n, k])
        if found != k:
            held = x[k:k + 1].copy()
            x[k] = x[found]
            x[found] = held[0]
    for i in range(n):
        for j in range(i):
            x[i] -= f[i, j] * x[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= f[i, j] * x[j]
        x[i] /= f[i, i]
    return x


def solved_transposed(f, b):
    """The solution with the transpose of a matrix that has been factored.

    >>> solved_transposed(factored(np.array([[1.0, 2.0], [2.0, 2.0]])), np.array([3.0, 4.0]))
    array([1., 1.])
    """
    n = f.shape[1]
    x = b.copy()
    for i in range(n):
        x[i] /= f[i, i]
        for j in range(i + 1, n):
            x[j] -= f[i, j] * x[i]
    for i in range(n - 1, -1, -1):
        for j in range(i):
            x[j] -= f[i, j] * x[i]
    for k in range(n - 1, -1, -1):
        found = int(f[n, k])
        if found != k:
            held = x[k:k + 1].copy()
            x[k] = x[found]
            x[found] = held[0]
    return x


def factors_gain(s, y):
    """What the factors gain of a solution `y` where its right side gains `s`: -s y.T, and zeros.

    >>> factors_gain(np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    array([[-3., -4.],
           [-6., -8.],
           [ 0.,  0.]])
    """
    n = s.shape[0]
    made = np.zeros((n + 1, n), s.dtype)
    if s.ndim == 1:
        made[:n] = np.outer(-s, y)
    else:
        made[:n] = -s.reshape(n, -1) @ y.reshape(n, -1).T
    return made


def of_matrix(e):
    """The shadow of a matrix as the shadow of its factors.

    >>> of_matrix(np.array([[5.0]]))
    array([[5.],
           [0.]])
    """
    made = np.zeros((e.shape[0] + 1, e.shape[1]), e.dtype)
    made[:-1] = e
    return made


def to_matrix(g):
    """The shadow of factors as the shadow of their matrix.

    >>> to_matrix(np.array([[5.0], [0.0]]))
    array([[5.]])
    """
    return g[:-1].copy()
