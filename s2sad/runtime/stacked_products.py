"""Products of stacks of matrices for compiled code, where NumPy has `np.matmul` and `np.swapaxes`."""
from __future__ import annotations

import numpy as np


def stacked_matmul(a, b):
    """The products of two stacks of as many matrices; small ones cost less without a call of BLAS.

    >>> stacked_matmul(np.array([[[2.0]], [[3.0]]]), np.array([[[5.0]], [[7.0]]]))
    array([[[10.]],
    <BLANKLINE>
           [[21.]]])
    """
    products = np.empty((a.shape[0], a.shape[1], b.shape[2]), a.dtype)
    if a.shape[1] * a.shape[2] * b.shape[2] > 256:
        for place in range(a.shape[0]):
            np.dot(np.ascontiguousarray(a[place]), np.ascontiguousarray(b[place]), products[place])
        return products
    for place in range(a.shape[0]):
        for i in range(a.shape[1]):
            for k in range(b.shape[2]):
                total = a.dtype.type(0)
                for j in range(a.shape[2]):
                    total += a[place, i, j] * b[place, j, k]
                products[place, i, k] = total
    return products


def stacked_transpose(a):
    """A copy of a stack of matrices with each of them transposed.

    >>> stacked_transpose(np.array([[[1.0, 2.0]]]))
    array([[[1.],
            [2.]]])
    """
    turned = np.empty((a.shape[0], a.shape[2], a.shape[1]), a.dtype)
    for place in range(a.shape[0]):
        for i in range(a.shape[1]):
            for j in range(a.shape[2]):
                turned[place, j, i] = a[place, i, j]
    return turned
