"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot):
    work = np.empty(2)
    work_dot = np.zeros_like(work)
    for i in range(x.size):
        work_dot[...] = 0.0
        work[...] = 0.0
        work_dot[0] = x[i] * x_dot[i] + x[i] * x_dot[i]
        work[0] = x[i] * x[i]
        work_here = work[0]
        work_dot[1] = x[i] * work_dot[0] + work_here * x_dot[i]
        work[1] = work_here * x[i]
        y_dot[i] = work_dot[0] + work_dot[1]
        y[i] = work[0] + work[1]
