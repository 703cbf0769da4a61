"""An arena: one array in which work arrays lie behind each other."""
from __future__ import annotations

import numpy as np


def allocate(arena, top, shape):
    """An array of unspecified content, and the place behind it: in the arena from `top` on, or new.

    >>> x, top = allocate(np.arange(100.0), 0, (2, 3))
    >>> x, top, allocate(np.empty(0), top, (2,))[1]
    (array([[0., 1., 2.],
           [3., 4., 5.]]), 24, 48)
    """
    size = 1
    for extent in shape:
        size *= extent
    last = top + (size + 23) // 8 * 8  # so that arrays do not begin at one offset in their pages
    if size >= 0 and last <= arena.size:
        return arena[top : top + size].reshape(shape), last
    return np.empty(shape), last


def allocate_zeros(arena, top, shape):
    """The same, filled with zeros.

    >>> allocate_zeros(np.arange(100.0), 8, (3,))
    (array([0., 0., 0.]), 32)
    """
    size = 1
    for extent in shape:
        size *= extent
    last = top + (size + 23) // 8 * 8
    if size >= 0 and last <= arena.size:
        found = arena[top : top + size]
        for k in range(size):
            found[k] = 0.0
        return found.reshape(shape), last
    return np.zeros(shape), last
