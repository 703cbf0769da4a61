"""Sparse matrices, as `scipy.sparse` has them: their entries, with the row and the column of each.

Entries at one place add up. What SciPy solves is left to it; products have a form in NumPy and one in loops, for
compiled code.
"""
from __future__ import annotations

import numpy as np


def sparse_rows(ends, columns):
    """The row of each entry of a matrix whose rows lie one behind the other, as in `csr_matrix`.

    >>> sparse_rows(np.array([0, 2, 2, 3]), np.array([0, 1, 1]))
    array([0, 0, 2])
    """
    count = ends.size - 1
    lengths = ends[1:] - ends[:-1]
    if count < 0 or ends[0] != 0 or ends[count] != columns.size or np.any(lengths < 0):
        raise ValueError("a sparse matrix whose indptr does not fit its indices")
    rows = np.repeat(np.arange(count), lengths)
    if np.any((rows[1:] == rows[:-1]) & (columns[1:] <= columns[:-1])):
        raise ValueError(
            "a sparse matrix whose indices are not in order, or twice there, which SciPy changes in "
            "place where it likes: call sum_duplicates() before, or build it with coo_matrix")
    return rows


def sparse_span(start, size):
    """The rows or the columns of the entries along a diagonal.

    >>> sparse_span(2, 3)
    array([2, 3, 4])
    """
    return np.arange(start, start + size)


def sparse_joined(first, second):
    """The rows or the columns of the entries of two matrices.

    >>> sparse_joined(np.array([0, 1]), np.array([3]))
    array([0, 1, 3])
    """
    return np.concatenate((first.astype(np.int64), second.astype(np.int64)))


def sparse_product(data, rows, columns, x, m, n):
    """The product of a matrix of m rows and n columns and x, a vector or a matrix.

    >>> rows, columns = np.array([0, 1, 1]), np.array([0, 0, 1])
    >>> sparse_product(np.array([2.0, 3.0, 4.0]), rows, columns, np.array([1.0, 2.0]), 2, 2)
    array([ 2., 11.])
    """
    sparse_fits(data, rows, columns, m, n, x.shape[0])
    if x.ndim == 1:
        return np.bincount(rows, data * x[columns], m).astype(x.dtype)
    product = np.empty((m, x.shape[1]), x.dtype)
    for column in range(x.shape[1]):
        product[:, column] = np.bincount(rows, data * x[columns, column], m)
    return product


def sparse_product_in_loops(data, rows, columns, x, m, n):
    """`sparse_product`, for compiled code.

    >>> rows, columns = np.array([0, 1]), np.array([1, 0])
    >>> sparse_product_in_loops(np.ones(2), rows, columns, np.array([[1.0], [2.0]]), 2, 2)
    array([[2.],
           [1.]])
    """
    if rows.size != data.size or columns.size != data.size or x.shape[0] != n:
        raise ValueError("a product with a sparse matrix of another size")
    product = np.zeros((m,) + x.shape[1:], x.dtype)
    for k in range(data.size):
        row, column = rows[k], columns[k]
        if row < 0 or row >= m or column < 0 or column >= n:
            raise ValueError("a sparse matrix with an entry outside of its shape")
        if x.ndim == 1:
            product[row] += data[k] * x[column]
        else:
            for j in range(x.shape[1]):
                product[row, j] += data[k] * x[column, j]
    return product


def sparse_fits(data, rows, columns, m, n, size):
    """Raises ValueError unless the entries are those of a matrix of m rows and n columns.

    Its product is taken with something that has `size` rows.
    """
    if rows.size != data.size or columns.size != data.size or size != n:
        raise ValueError("a product with a sparse matrix of another size")
    if data.size and (rows.min() < 0 or rows.max() >= m or columns.min() < 0 or columns.max() >= n):
        raise ValueError("a sparse matrix with an entry outside of its shape")


def sparse_left_product(x, data, rows, columns, m, n):
    """The product of x, a vector or a matrix, and a sparse matrix.

    >>> rows, columns = np.array([0, 1]), np.array([0, 0])
    >>> sparse_left_product(np.array([1.0, 2.0]), np.array([2.0, 3.0]), rows, columns, 2, 2)
    array([8., 0.])
    """
    return sparse_product(data, columns, rows, x.T, n, m).T


def sparse_left_product_in_loops(x, data, rows, columns, m, n):
    """`sparse_left_product`, for compiled code.

    >>> rows, columns = np.array([0, 1]), np.array([0, 0])
    >>> sparse_left_product_in_loops(np.ones((1, 2)), np.ones(2), rows, columns, 2, 2)
    array([[2., 0.]])
    """
    return sparse_product_in_loops(data, columns, rows, x.T, n, m).T.copy()


def sparse_gain(left, right, rows, columns):
    """For each entry the product of what lies at its row and at its column, summed along rows.

    >>> sparse_gain(np.array([1.0, 2.0]), np.array([3.0, 4.0]), np.array([0, 1]), np.array([1, 1]))
    array([4., 8.])
    """
    sparse_fits(rows, rows, columns, left.shape[0], right.shape[0], right.shape[0])
    if left.ndim == 1:
        return left[rows] * right[columns]
    return np.sum(left[rows] * right[columns], axis=1)


def sparse_gain_in_loops(left, right, rows, columns):
    """`sparse_gain`, for compiled code.

    >>> sparse_gain_in_loops(np.ones((2, 3)), np.ones((2, 3)), np.array([0, 1]), np.array([1, 1]))
    array([3., 3.])
    """
    gain = np.zeros(rows.size, left.dtype)
    for k in range(rows.size):
        row, column = rows[k], columns[k]
        if row < 0 or row >= left.shape[0] or column < 0 or column >= right.shape[0]:
            raise ValueError("a sparse matrix with an entry outside of its shape")
        if left.ndim == 1:
            gain[k] = left[row] * right[column]
        else:
            for j in range(left.shape[1]):
                gain[k] += left[row, j] * right[column, j]
    return gain


def sparse_dense(data, rows, columns, m, n):
    """The matrix with all its elements.

    >>> sparse_dense(np.array([2.0, 3.0]), np.array([0, 0]), np.array([1, 1]), 1, 2)
    array([[0., 5.]])
    """
    sparse_fits(data, rows, columns, m, n, n)
    places = rows.astype(np.int64) * n + columns
    return np.bincount(places, data, m * n).astype(data.dtype).reshape((m, n))


def sparse_entries(full, rows, columns):
    """The elements of a matrix at the places of the entries.

    >>> sparse_entries(np.array([[1.0, 2.0]]), np.array([0, 0]), np.array([1, 1]))
    array([2., 2.])
    """
    sparse_fits(rows, rows, columns, full.shape[0], full.shape[1], full.shape[1])
    flat = full.copy().reshape(full.size)
    return flat[rows.astype(np.int64) * full.shape[1] + columns]


def sparse_diagonal(data, rows, columns, m, n, size):
    """The diagonal, of the smaller of both sizes.

    >>> rows, columns = np.array([0, 0, 1]), np.array([0, 1, 1])
    >>> sparse_diagonal(np.array([2.0, 3.0, 4.0]), rows, columns, 2, 3, 2)
    array([2., 4.])
    """
    sparse_fits(data, rows, columns, m, n, n)
    here = rows == columns
    return np.bincount(rows[here], data[here], size).astype(data.dtype)


def sparse_diagonal_gain(g, rows, columns, m, n):
    """What the entries gain of the diagonal.

    >>> sparse_diagonal_gain(np.array([5.0, 6.0]), np.array([0, 0, 1]), np.array([0, 1, 1]), 2, 2)
    array([5., 0., 6.])
    """
    sparse_fits(rows, rows, columns, m, n, n)
    gain = np.zeros(rows.size, g.dtype)
    here = rows == columns
    gain[here] = g[rows[here]]
    return gain


def sparse_solve(data, rows, columns, b, m, n, kept):
    """The solution with a sparse matrix of m rows and n columns.

    It is `splu(a).solve(b)` of `scipy.sparse.linalg` if `kept`, else `spsolve(a, b)`, which gives
    nan where the matrix is singular.
    """
    if not kept and b.ndim == 2 and b.shape[1] == 1:
        raise ValueError("spsolve takes a matrix of one column for a vector: give it that column")
    if m != n or b.shape[0] != n:
        raise ValueError("a sparse matrix that is not square, or a right side of another size")
    factors, flipped = sparse_factors(data, rows, columns, n)
    if factors is None and kept:
        raise RuntimeError("Factor is exactly singular")
    if factors is None:
        return np.full(b.shape, np.nan, b.dtype)
    solution = factors.solve(np.ascontiguousarray(b), "T" if flipped else "N")
    return np.ascontiguousarray(solution.astype(b.dtype))


def sparse_factors(data, rows, columns, n):
    """The factors of a matrix, None if it is singular, and whether they are its transpose's.

    The last ones are kept: the reverse sweep solves with the same matrices.
    """
    kept = sparse_factors.__dict__.setdefault("kept", [])
    for held in list(kept):
        for flipped in (False, True):
            given = (data, columns, rows) if flipped else (data, rows, columns)
            same = [a.dtype == b.dtype and np.array_equal(a, b) for a, b in zip(held[1], given)]
            if held[0] == n and all(same):
                return held[2], flipped
    try:
        from scipy.sparse import coo_matrix
        from scipy.sparse.linalg import splu
    except ImportError:
        raise ImportError('a sparse matrix needs SciPy: pip install "s2sad[jit]"') from None
    sparse_fits(data, rows, columns, n, n, n)
    matrix = coo_matrix((data, (rows, columns)), shape=(n, n)).tocsc()
    try:
        factors = splu(matrix)
    except RuntimeError:
        factors = None
    kept.insert(0, (n, (data.copy(), rows.copy(), columns.copy()), factors))
    del kept[4:]
    return factors, False
