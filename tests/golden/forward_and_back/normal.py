"""kernel in normal form."""

import math

import numpy as np


def kernel(x, scales):
    work = np.empty(scales.size)
    total = 0.0
    total_1 = total
    for i in range(x.size):
        work[0] = scales[0] * x[i]
        for k in range(1, scales.size):
            work_here = work[k - 1]
            work[k] = math.sin(work_here) * scales[k]
        work_here_2 = work[scales.size - 1]
        total_1 += work_here_2 ** 2
    return total_1
