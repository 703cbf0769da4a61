"""Places in arrays, whose number depends on what the arrays hold."""
from __future__ import annotations

import numpy as np


def places(x, count, part):
    """`np.nonzero(x)[part]`, of which there are `count`.

    >>> places(np.array([[0.0, 2.0], [3.0, 4.0]]), 3, 1)
    array([1, 0, 1])
    """
    return np.nonzero(x)[part]


def sought(a, v, right):
    """`np.searchsorted(a, v, side)`, the right side or the left.

    >>> sought(np.array([1.0, 2.0]), np.array([0.5, 2.0]), True)
    array([0, 2])
    """
    if right:
        return np.searchsorted(a, v, side="right")
    return np.searchsorted(a, v)
