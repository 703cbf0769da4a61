"""Tangent of kernel: d(return) / d(x, scales).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    scales: float64[:], in
"""

import math

import numpy as np


def kernel_tangent(x, x_dot, scales, scales_dot):
    work = np.empty(scales.size)
    work_dot = np.zeros_like(work)
    total_1_dot = 0.0
    for i in range(x.size):
        work_dot[0] = x[i] * scales_dot[0] + scales[0] * x_dot[i]
        work[0] = scales[0] * x[i]
        for k in range(1, scales.size):
            work_here = work[k - 1]
            work_dot[k] = (
                scales[k] * (np.cos(work_here) * work_dot[k - 1]) +
                math.sin(work_here) * scales_dot[k]
            )
            work[k] = math.sin(work_here) * scales[k]
        total_1_dot += 2.0 * work[scales.size - 1] * work_dot[scales.size - 1]
    return total_1_dot,
