"""Stacks that grow: a typed array and the count of what lies on it."""
from __future__ import annotations

import numpy as np


def grow(stack, top):
    """A stack with a row `top`: the same one if it has it, else a copy with twice the rows or more.

    Rows lie along the first axis; what is above the old rows of a copy is unspecified.

    >>> stack = np.array([1.5, 2.5])
    >>> grow(stack, 1) is stack, grow(stack, 2).shape, grow(stack, 2)[:2]
    (True, (4,), array([1.5, 2.5]))
    """
    rows = stack.shape[0]
    if top < rows:
        return stack
    larger = np.empty((max(2 * rows, top + 1),) + stack.shape[1:], stack.dtype)
    if hasattr(stack, "__array_interface__"):  # an attribute that Numba's arrays lack
        larger[:rows] = stack
    else:  # Numba compiles a loop sooner than a slice
        old, new = stack.ravel(), larger.ravel()
        for k in range(old.size):
            new[k] = old[k]
    return larger


def sized(stack, shape):
    """A stack of this shape: the same one if it has it, else a new one of unspecified content.

    >>> stack = np.array([1.5, 2.5])
    >>> sized(stack, (2,)) is stack, sized(stack, (3,)).shape
    (True, (3,))
    """
    return stack if stack.shape == shape else np.empty(shape, stack.dtype)
