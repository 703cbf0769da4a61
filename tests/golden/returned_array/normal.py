"""Normal form."""

import numpy as np


def kernel(u, a):
    out = np.zeros_like(u)
    for i in range(1, u.size):
        out[i] = u[i] - u[i - 1]
    slope = np.empty_like(out)
    slope[...] = a * out
    returned = np.empty(max(u.shape[0] - 1, 0))
    returned[...] = u[1:]
    return slope, returned, slope
