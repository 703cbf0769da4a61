"""Tangent of kernel: d(y) / d(y, x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot):
    order = np.zeros(x.size, np.int64)
    flags = np.zeros(x.size, np.bool_)
    for i in range(x.size):
        order[i] = x.size - 1 - i
        flags[i] = x[i] > 0.0
    for i in range(x.size):
        if flags[order[i]]:
            place = order[i]
            y_dot[i] = x[i] * x_dot[place] + x[place] * x_dot[i]
            y[i] = x[place] * x[i]
