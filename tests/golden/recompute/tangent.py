"""Tangent of kernel: d(y) / d(x, scale).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
    scale: float64, in
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot, scale, scale_dot):
    n = x.size
    exp_value = np.exp(scale)
    exp_value_dot = exp_value * scale_dot if scale_dot != 0.0 else 0.0
    factor = exp_value / n
    factor_dot = exp_value_dot / np.float64(n) if exp_value_dot != 0.0 else 0.0
    for i in range(n):
        last = n - 1 - i
        bent = np.sin(x[last]) * factor
        slope = np.sin(x[last])
        bent_dot = (
            factor * (np.cos(x[last]) * x_dot[last]) + (slope * factor_dot if slope != 0.0 else 0.0)
        )
        y_dot[i] = (
            (bent * bent_dot if bent != 0.0 else 0.0) + (bent * bent_dot if bent != 0.0 else 0.0)
        )
        y[i] = bent * bent
