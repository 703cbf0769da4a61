"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
"""

# ruff: noqa: FURB136, PLR1730, RUF100

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(x.size):
        root = np.sqrt(x[i])
        root_dot = 0.5 * x_dot[i] / root if x_dot[i] != 0.0 else 0.0
        if x[i] > 0.0:
            y_dot[i] = root_dot
            y[i] = root
        else:
            y_dot[i] = 0.0
            y[i] = 0.0
