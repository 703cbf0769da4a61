"""Normal form."""

import math

import numpy as np


def kernel(x, scales):
    work = np.empty(scales.size)
    total = 0.0
    total_1 = total
    for i in range(x.size):
        for k in range(scales.size):
            work[k] = math.sin(scales[k] * x[i])
        for k in range(scales.size):
            work_here = work[k]
            total_1 += work_here * work_here
    return total_1
