"""Adjoint of kernel: d(return) / d(x, scales).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    scales: float64[:], in

It records nothing.
"""

import numpy as np


def kernel_adjoint(x, x_bar, scales, scales_bar, result_bar):
    # forward sweep: only what the reverse sweep reads
    work = np.empty(scales.size)
    # reverse sweep
    work_bar = np.zeros_like(work)
    # return total
    total_bar = result_bar
    for i in range(x.size - 1, -1, -1):
        for k in range(scales.size):
            work[k] = np.sin(scales[k] * x[i])
        for k in range(scales.size - 1, -1, -1):
            # total += work[k] * work[k]
            work_bar[k] += 2.0 * (work[k] * total_bar)
        for k in range(scales.size - 1, -1, -1):
            # work[k] = math.sin(scales[k] * x[i])
            seed = work_bar[k]
            work_bar[k] = 0.0
            seed = np.cos(scales[k] * x[i]) * seed
            scales_bar[k] += x[i] * seed
            x_bar[i] += scales[k] * seed
