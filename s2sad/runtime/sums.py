"""Sums whose rounding error grows with the logarithm of the length, not with the length."""
from __future__ import annotations

import numpy as np


def added(total, gain):
    """A sum with one more gain, where gains may come in any order: Numba compiles a loop of these
    to partial sums, which are faster and round less.

    >>> added(1.0, 2.0)
    3.0
    """
    return total + gain


def pairwise_sum(x):
    """The sum of a float array's elements, of any shape, rounded as NumPy's own pairwise sum is.

    NumPy's sum is used where there is NumPy only. Compiled by Numba, whose `sum` is one long
    addition, blocks are added in independent accumulators, which vectorises, and the blocks' sums
    in pairs (N. J. Higham, SIAM J. Sci. Comput. 14, 1993).

    >>> float(pairwise_sum(np.full((10, 100), 0.5)))
    500.0
    """
    flat = x.ravel()
    if hasattr(x, "__array_interface__"):  # an attribute that Numba's arrays lack
        return np.sum(flat)
    return blocked_sum(flat)


def blocked_sum(x):
    """The sum of a one-dimensional float array: blocks of 128 elements, their sums added in pairs.

    >>> float(blocked_sum(np.arange(1000.0)))
    499500.0
    """
    zero = x.dtype.type(0)
    blocks = x.size // 128
    waiting = np.empty(64, x.dtype)  # [k]: the sum of 2 ** k blocks, until its like comes
    lanes = np.empty(16, x.dtype)
    for block in range(blocks):
        part = x[128 * block:128 * block + 128]
        for lane in range(16):
            lanes[lane] = part[lane]
        for row in range(16, 128, 16):
            for lane in range(16):
                lanes[lane] += part[row + lane]
        total = zero
        for lane in range(16):
            total += lanes[lane]
        level = 0
        while block >> level & 1:
            total += waiting[level]
            level += 1
        waiting[level] = total
    total = zero
    for k in range(128 * blocks, x.size):
        total += x[k]
    level = 0
    while blocks >> level:
        if blocks >> level & 1:
            total += waiting[level]
        level += 1
    return total
