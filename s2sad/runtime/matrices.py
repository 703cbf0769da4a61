"""Derivatives of functions of matrices, and the parts of results that NumPy gives as a tuple.

`*_gain(..., g)` is what a matrix gains from the shadow `g` of the result, `*_change(..., e)` the
change of the result for a change `e` of the matrix (M. Giles, Collected matrix derivative results
for forward and reverse mode AD, 2008).
"""
from __future__ import annotations

import numpy as np


def det_sign(a):
    """The sign of a determinant, `np.linalg.slogdet(a)[0]`.

    >>> float(det_sign(np.array([[0.0, 2.0], [1.0, 0.0]])))
    -1.0
    """
    return np.linalg.slogdet(a)[0]


def log_det(a):
    """The logarithm of a determinant's size, `np.linalg.slogdet(a)[1]`.

    >>> float(log_det(np.eye(3)))
    0.0
    """
    return np.linalg.slogdet(a)[1]


def cofactors(a):
    """The derivative of a determinant, also where it is 0: det(a) * inv(a).T by singular values
    (G. W. Stewart, On the adjugate matrix, 1998).

    >>> cofactors(np.array([[1.0, 0.0], [0.0, 0.0]])).round(12) + 0.0
    array([[0., 0.],
           [0., 1.]])
    """
    u, s, vt = np.linalg.svd(a)
    others = np.ones_like(s)
    for k in range(1, s.size):  # the product of all the others, without a division
        others[k] = others[k - 1] * s[k - 1]
    behind = np.linalg.det(u) * np.linalg.det(vt)
    for k in range(s.size - 1, -1, -1):
        others[k] *= behind
        behind *= s[k]
    return (u * others) @ vt


def from_lower(e):
    """The symmetric matrix with this lower triangle: all that LAPACK reads of one.

    >>> from_lower(np.array([[1.0, 9.0], [2.0, 3.0]]))
    array([[1., 2.],
           [2., 3.]])
    """
    return np.tril(e) + np.tril(e, -1).T


def to_lower(s):
    """What the lower triangle gains where the symmetric matrix gains `s`.

    >>> to_lower(np.array([[1.0, 4.0], [2.0, 3.0]]))
    array([[1., 0.],
           [6., 3.]])
    """
    return np.tril(s) + np.triu(s, 1).T


def half_lower(p):
    """The lower triangle with half of the diagonal.

    >>> half_lower(np.array([[2.0, 4.0], [2.0, 6.0]]))
    array([[1., 0.],
           [2., 3.]])
    """
    return np.tril(p) - p.dtype.type(0.5) * np.diag(np.diag(p))


def cholesky_gain(y, g):
    """For `y = np.linalg.cholesky(a)`, of whose argument the lower triangle is read
    (I. Murray, Differentiation of the Cholesky decomposition, 2016).

    >>> cholesky_gain(np.array([[2.0]]), np.array([[1.0]]))
    array([[0.25]])
    """
    p = half_lower(y.T @ np.tril(g))
    return to_lower(np.linalg.solve(y.T, np.linalg.solve(y.T, p).T))


def cholesky_change(y, e):
    """The change of `y = np.linalg.cholesky(a)`.

    >>> cholesky_change(np.array([[2.0]]), np.array([[1.0]]))
    array([[0.25]])
    """
    return y @ half_lower(np.linalg.solve(y, np.linalg.solve(y, from_lower(e)).T))


def eigenvectors(a):
    """The vectors of `np.linalg.eigh(a)`.

    >>> abs(eigenvectors(np.array([[1.0, 0.0], [0.0, 2.0]])))
    array([[1., 0.],
           [0., 1.]])
    """
    return np.linalg.eigh(a)[1]


def eigenvalues_gain(a, g):
    """For `np.linalg.eigvalsh(a)`, of whose argument the lower triangle is read.

    >>> eigenvalues_gain(np.array([[1.0, 0.0], [0.0, 2.0]]), np.array([3.0, 5.0]))
    array([[3., 0.],
           [0., 5.]])
    """
    v = np.linalg.eigh(a)[1]
    return to_lower((v * g) @ v.T)


def eigenvalues_change(a, e):
    """The change of `np.linalg.eigvalsh(a)`.

    >>> e = np.array([[3.0, 0.0], [1.0, 5.0]])
    >>> eigenvalues_change(np.array([[1.0, 0.0], [0.0, 2.0]]), e)
    array([3., 5.])
    """
    v = np.linalg.eigh(a)[1]
    return np.sum(v * (from_lower(e) @ v), axis=0)


def eigenvectors_gain(a, y, g):
    """For `y = eigenvectors(a)`; infinite where eigenvalues coincide that the seed tells apart.

    >>> eigenvectors_gain(np.array([[1.0, 0.0], [0.0, 3.0]]), np.eye(2), np.eye(2)[::-1].copy())
    array([[0., 0.],
           [0., 0.]])
    """
    return to_lower(y @ apart(y.T @ g, a, y) @ y.T)


def eigenvectors_change(a, y, e):
    """The change of `y = eigenvectors(a)`.

    >>> e = np.array([[0.0, 0.0], [1.0, 0.0]])
    >>> eigenvectors_change(np.array([[1.0, 0.0], [0.0, 3.0]]), np.eye(2), e)
    array([[ 0. ,  0.5],
           [-0.5,  0. ]])
    """
    return y @ apart(y.T @ (from_lower(e) @ y), a, y)


def apart(p, a, v):
    """`p` over the differences of the eigenvalues, column less row; 0 where `p` is 0, and on the
    diagonal.

    >>> apart(np.ones((2, 2)), np.array([[1.0, 0.0], [0.0, 3.0]]), np.eye(2))
    array([[ 0. ,  0.5],
           [-0.5,  0. ]])
    """
    w = np.sum(v * (from_lower(a) @ v), axis=0)
    q = np.zeros_like(p)
    for i in range(w.size):
        for j in range(w.size):
            if i != j and p[i, j] != 0.0:
                q[i, j] = p[i, j] / (w[j] - w[i])
    return q


def singular_values(a):
    """`np.linalg.svd(a, compute_uv=False)`.

    >>> singular_values(np.array([[0.0, -3.0], [2.0, 0.0]]))
    array([3., 2.])
    """
    return np.linalg.svd(a, False)[1]


def singular_values_gain(a, g):
    """For `singular_values(a)`.

    >>> singular_values_gain(np.array([[3.0, 0.0], [0.0, 2.0]]), np.array([1.0, 5.0]))
    array([[1., 0.],
           [0., 5.]])
    """
    u, _, vt = np.linalg.svd(a, False)
    return (u * g) @ vt


def singular_values_change(a, e):
    """The change of `singular_values(a)`.

    >>> e = np.array([[1.0, 7.0], [0.0, 5.0]])
    >>> singular_values_change(np.array([[3.0, 0.0], [0.0, 2.0]]), e)
    array([1., 5.])
    """
    u, _, vt = np.linalg.svd(a, False)
    return np.sum(u * (e @ vt.T), axis=0)


def power_change(a, n, e):
    """The change of `np.linalg.matrix_power(a, n)`: a block of the power of a matrix of blocks
    (R. Mathias, SIAM J. Matrix Anal. Appl. 17, 1996).

    >>> power_change(np.array([[2.0]]), 3, np.array([[1.0]]))
    array([[12.]])
    """
    m = a.shape[0]
    blocks = np.zeros((2 * m, 2 * m), a.dtype)
    blocks[:m, :m] = a
    blocks[m:, m:] = a
    blocks[:m, m:] = e
    return np.linalg.matrix_power(blocks, n)[:m, m:].copy()


def least_squares(a, b):
    """The solution of `np.linalg.lstsq(a, b, rcond=None)`.

    >>> least_squares(np.array([[1.0], [1.0]]), np.array([1.0, 3.0])).round(12)
    array([2.])
    """
    return np.linalg.lstsq(a, b, np.finfo(a.dtype).eps * max(a.shape))[0]


def least_squares_change(a, b, y, e, f):
    """The change of `y = least_squares(a, b)` for changes e of a and f of b
    (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 1973: the rank does not change near by).

    >>> a, e = np.array([[1.0], [1.0]]), np.array([[1.0], [0.0]])
    >>> least_squares_change(a, np.array([1.0, 3.0]), np.array([2.0]), e, np.zeros(2)).round(12)
    array([-1.5])
    """
    p = np.linalg.pinv(a)
    z = e.T @ (p.T @ y)
    return p @ (f - e @ y) + p @ (p.T @ (e.T @ (b - a @ y))) + (z - p @ (a @ z))
