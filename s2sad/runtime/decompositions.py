"""Parts of decompositions of a matrix, their derivatives, and the exponential of a matrix.

Of QR after S. Walter, L. Lehmann, 2012, and H.-J. Liao et al., Phys. Rev. X 9, 2019; of singular
vectors after M. Giles, 2008; `*_gain(..., g)` and `*_change(..., e)` as in `matrices`.
"""
from __future__ import annotations

import numpy as np


def orthogonal_part(a):
    """`np.linalg.qr(a)[0]`.

    >>> abs(orthogonal_part(np.array([[3.0], [4.0]])))
    array([[0.6],
           [0.8]])
    """
    return np.linalg.qr(a)[0]


def triangular_part(a):
    """`np.linalg.qr(a)[1]`.

    >>> abs(triangular_part(np.array([[3.0], [4.0]])))
    array([[5.]])
    """
    return np.linalg.qr(a)[1]


def both_parts_gain(q, r, gain_q, gain_r):
    """For both parts of a matrix with no more columns than rows.

    >>> one = np.array([[1.0]])
    >>> both_parts_gain(one, 2.0 * one, 0.0 * one, one)
    array([[1.]])
    """
    m = r @ gain_r.T - gain_q.T @ q
    even = np.tril(m) + np.tril(m, -1).T
    return np.linalg.solve(r, (gain_q + q @ even).T).T


def orthogonal_part_gain(a, g):
    """For `orthogonal_part(a)`.

    >>> orthogonal_part_gain(np.array([[2.0]]), np.array([[1.0]])) + 0.0
    array([[0.]])
    """
    m = min(a.shape)
    q, r = np.linalg.qr(a)
    made = np.zeros_like(a)
    square = r[:, :m].copy()
    made[:, :m] = both_parts_gain(q, square, g, np.zeros_like(square))
    return made


def triangular_part_gain(a, g):
    """For `triangular_part(a)`.

    >>> abs(triangular_part_gain(np.array([[2.0]]), np.array([[1.0]])))
    array([[1.]])
    """
    m = min(a.shape)
    q, r = np.linalg.qr(a)
    made = np.zeros_like(a)
    upper = np.triu(g)
    made[:, :m] = both_parts_gain(q, r[:, :m].copy(), a[:, m:] @ upper[:, m:].T, upper[:, :m].copy())
    made[:, m:] = q @ upper[:, m:]
    return made


def orthogonal_part_change(a, e):
    """The change of `orthogonal_part(a)`.

    >>> orthogonal_part_change(np.array([[2.0]]), np.array([[1.0]])) + 0.0
    array([[0.]])
    """
    m = min(a.shape)
    q, r = np.linalg.qr(a)
    square = r[:, :m].copy()
    scaled = np.linalg.solve(square.T, e[:, :m].T.copy()).T
    c = q.T @ scaled
    return scaled - q @ (np.triu(c) + np.tril(c, -1).T)


def triangular_part_change(a, e):
    """The change of `triangular_part(a)`.

    >>> abs(triangular_part_change(np.array([[2.0]]), np.array([[1.0]])))
    array([[1.]])
    """
    q = np.linalg.qr(a)[0]
    made = orthogonal_part_change(a, e).T @ a + q.T @ e
    return np.triu(made)


def left_vectors(a):
    """`np.linalg.svd(a, full_matrices=False)[0]`.

    >>> abs(left_vectors(np.array([[3.0], [4.0]]))).round(12)
    array([[0.6],
           [0.8]])
    """
    return np.linalg.svd(a, False)[0]


def right_vectors(a):
    """`np.linalg.svd(a, full_matrices=False)[2]`.

    >>> abs(right_vectors(np.array([[3.0], [4.0]]))).round(12)
    array([[1.]])
    """
    return np.linalg.svd(a, False)[2]


def over_squares(p, s):
    """`p` over the differences of the squares of `s`, column less row; 0 where `p` is 0, and on the
    diagonal.

    >>> over_squares(np.ones((2, 2)), np.array([2.0, 1.0]))
    array([[ 0.        , -0.33333333],
           [ 0.33333333,  0.        ]])
    """
    found = np.zeros_like(p)
    for i in range(s.size):
        for j in range(s.size):
            if i != j and p[i, j] != 0.0:
                found[i, j] = p[i, j] / ((s[j] - s[i]) * (s[j] + s[i]))
    return found


def left_vectors_gain(a, g):
    """For `left_vectors(a)`; infinite where singular values coincide that the seed tells apart.

    >>> left_vectors_gain(np.array([[2.0]]), np.array([[1.0]])) + 0.0
    array([[0.]])
    """
    u, s, vt = np.linalg.svd(a, False)
    p = u.T @ g
    return ((u @ over_squares(p - p.T, s)) * s + (g - u @ p) / s) @ vt


def right_vectors_gain(a, g):
    """For `right_vectors(a)`; infinite where singular values coincide that the seed tells apart.

    >>> right_vectors_gain(np.array([[2.0]]), np.array([[1.0]])) + 0.0
    array([[0.]])
    """
    u, s, vt = np.linalg.svd(a, False)
    p = vt @ g.T
    return u @ ((vt.T @ over_squares(p - p.T, s)) * s + (g.T - vt.T @ p) / s).T


def left_vectors_change(a, e):
    """The change of `left_vectors(a)`.

    >>> left_vectors_change(np.array([[2.0]]), np.array([[1.0]])) + 0.0
    array([[0.]])
    """
    u, s, vt = np.linalg.svd(a, False)
    f = e @ vt.T
    p = u.T @ f
    return u @ over_squares(p * s + (p * s).T, s) + (f - u @ p) / s


def right_vectors_change(a, e):
    """The change of `right_vectors(a)`.

    >>> right_vectors_change(np.array([[2.0]]), np.array([[1.0]])) + 0.0
    array([[0.]])
    """
    u, s, vt = np.linalg.svd(a, False)
    f = e.T @ u
    p = vt @ f
    return (vt.T @ over_squares(p * s + (p * s).T, s) + (f - vt.T @ p) / s).T


def exponential(a):
    """`scipy.linalg.expm(a)`: a Pade approximant of degree 13 of the scaled matrix, squared as often
    (N. Higham, SIAM J. Matrix Anal. Appl. 26, 2005).

    >>> exponential(np.array([[0.0, 1.0], [0.0, 0.0]]))
    array([[1., 1.],
           [0., 1.]])
    """
    size = 0.0
    for j in range(a.shape[1]):
        size = max(size, np.sum(np.abs(a[:, j])))
    times = 0
    while size > 5.371920351148152:
        size *= 0.5
        times += 1
    x = a * a.dtype.type(0.5 ** times)
    power = np.eye(a.shape[0]).astype(a.dtype)
    even, odd = power.copy(), power * a.dtype.type(0.5)
    square = x @ x
    factor = 1.0
    for k in range(1, 14):
        factor *= (14 - k) / (k * (27 - k))
        if k % 2 == 0:
            power = power @ square
            even += a.dtype.type(factor) * power
        elif k > 1:
            odd += a.dtype.type(factor) * power
    odd = x @ odd
    made = np.linalg.solve(even - odd, even + odd)
    for _ in range(times):
        made = made @ made
    return made


def exponential_change(a, e):
    """The change of `exponential(a)`: a block of the exponential of a matrix of blocks
    (R. Mathias, SIAM J. Matrix Anal. Appl. 17, 1996).

    >>> exponential_change(np.array([[0.0]]), np.array([[1.0]]))
    array([[1.]])
    """
    m = a.shape[0]
    blocks = np.zeros((2 * m, 2 * m), a.dtype)
    blocks[:m, :m] = a
    blocks[m:, m:] = a
    blocks[:m, m:] = e
    return exponential(blocks)[:m, m:].copy()
