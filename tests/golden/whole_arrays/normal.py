"""Normal form."""

import numpy as np


def kernel(y, x, a):
    assert y.shape == x.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    y[...] = a * x + y
    y[...] = y * np.sin(x)
    result = np.sum(y * y)
    return result
