"""Tangent of kernel: d(y) / d(x, scale).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
    scale: float64, in
"""

# ruff: noqa: FURB136, RUF100

import math

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot, scale, scale_dot):
    n = x.size
    exp_value = math.exp(scale)
    exp_value_dot = exp_value * scale_dot
    factor = exp_value / n
    factor_dot = exp_value_dot / n if exp_value_dot != 0.0 else 0.0
    for i in range(n):
        last = n - 1 - i
        bent = math.sin(x[last]) * factor
        bent_dot = factor * (np.cos(x[last]) * x_dot[last]) + math.sin(x[last]) * factor_dot
        y_dot[i] = bent * bent_dot + bent * bent_dot
        y[i] = bent * bent
