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
    products = np.empty(a.shape[:-1] + (b.shape[-1],), a.dtype)
    left, right, made = flat_stack(a), flat_stack(b), flat_stack(products)
    if left.shape[1] * left.shape[2] * right.shape[2] > 256:
        for place in range(left.shape[0]):
            np.dot(left[place], right[place], made[place])
        return products
    for place in range(left.shape[0]):
        for i in range(left.shape[1]):
            for k in range(right.shape[2]):
                total = a.dtype.type(0)
                for j in range(left.shape[2]):
                    total += left[place, i, j] * right[place, j, k]
                made[place, i, k] = total
    return products


def stacked_transpose(a):
    """A copy of a stack of matrices with each of them transposed.

    >>> stacked_transpose(np.array([[[1.0, 2.0]]]))
    array([[[1.],
            [2.]]])
    """
    turned = np.empty(a.shape[:-2] + (a.shape[-1], a.shape[-2]), a.dtype)
    given, made = flat_stack(a), flat_stack(turned)
    for place in range(given.shape[0]):
        for i in range(given.shape[1]):
            for j in range(given.shape[2]):
                made[place, j, i] = given[place, i, j]
    return turned


def flat_stack(stack) -> np.ndarray:
    """The stack with one axis that counts its matrices, contiguous.

    >>> flat_stack(np.zeros((2, 3, 4, 5))).shape
    (6, 4, 5)
    """
    count = 1
    for size in stack.shape[:-2]:
        count *= size
    return np.ascontiguousarray(stack).reshape((count, stack.shape[-2], stack.shape[-1]))
