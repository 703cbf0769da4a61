"""Tangent of kernel: d(y) / d(x, top).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
    top: float64, in
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot, top, top_dot):
    for i in range(x.size):
        y_dot[i] = (
            abs(x[i]) * (
                (0.0 if top < max(x[i], 0.1) else 0.0 if 0.1 > x[i] else x_dot[i]) +
                (top_dot if top < max(x[i], 0.1) else 0.0)
            ) + min(max(x[i], 0.1), top) * (np.sign(x[i]) * x_dot[i])
        )
        y[i] = min(max(x[i], 0.1), top) * abs(x[i])
