"""Tangent of kernel: d(return) / d(x, scales).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    scales: float64[:], in
"""

import numpy as np


def kernel_tangent(x, x_dot, scales, scales_dot):
    work = np.empty(scales.size)
    work_dot = np.zeros_like(work)
    total_dot = 0.0
    for i in range(x.size):
        for k in range(scales.size):
            work_dot[k] = np.cos(scales[k] * x[i]) * (x[i] * scales_dot[k] + scales[k] * x_dot[i])
            work[k] = np.sin(scales[k] * x[i])
        for k in range(scales.size):
            work_here = work[k]
            work_here_dot = work_dot[k]
            total_dot += work_here * work_here_dot + work_here * work_here_dot
    return (total_dot,)
