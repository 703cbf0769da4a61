"""Iterations that share nothing but a sum: each is run forwards and back at once, its work array recorded by no one."""
import math

import numpy as np


def kernel(x, scales):
    work = np.empty(scales.size)
    total = 0.0
    for i in range(x.size):
        for k in range(scales.size):
            work[k] = math.sin(scales[k] * x[i])
        for k in range(scales.size):
            total += work[k] * work[k]
    return total


ARGUMENTS = (np.array([0.7, -1.3, 0.4]), np.array([1.2, 0.8, 1.5]))
WRT, OF = ("x", "scales"), ("return",)
