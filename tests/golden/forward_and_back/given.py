"""Iterations that share nothing but a sum: each is run forwards and back at once, its work array recorded once."""
import math

import numpy as np


def kernel(x, scales):
    work = np.empty(scales.size)
    total = 0.0
    for i in range(x.size):
        work[0] = scales[0] * x[i]
        for k in range(1, scales.size):
            work[k] = math.sin(work[k - 1]) * scales[k]
        total += work[scales.size - 1] ** 2
    return total


ARGUMENTS = (np.array([0.7, -1.3, 0.4]), np.array([1.2, 0.8, 1.5]))
WRT, OF = ("x", "scales"), ("return",)
