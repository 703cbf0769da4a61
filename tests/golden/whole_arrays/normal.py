"""Normal form."""

import numpy as np


def kernel(y, x, a):
    assert y.shape == x.shape
    y[...] = a * x + y
    y[...] = y * np.sin(x)
    result = np.sum(y * y)
    return result
