"""Tangent of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float32[:], out
    x: float32[:], in
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot):
    for i in range(x.size):
        half = np.float32(0.5) * x[i]
        half_dot = np.float32(0.5) * x_dot[i]
        exp_value = np.exp(np.float64(half))
        y_dot[i] = (
            exp_value * half_dot +
            (half * (exp_value * half_dot if half_dot != 0.0 else 0.0) if half != 0.0 else 0.0)
        )
        y[i] = half * exp_value
