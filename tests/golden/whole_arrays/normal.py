"""Normal form."""

import numpy as np


def kernel(y, x, a):
    assert y.shape == x.shape
    y[...] = a * x + y
    assert y.shape == x.shape
    y[...] = y * np.sin(x)
    result = np.sum(y * y)
    return result
