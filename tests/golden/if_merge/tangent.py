"""Tangent of kernel: d(return) / d(a, b).

Engine: NumPy. Level: plain. Arguments:
    a: float64, in
    b: float64, in
"""

# ruff: noqa: PLR1730, RUF100

import numpy as np


def kernel_tangent(a, a_dot, b, b_dot):
    c = a
    c_dot = a_dot
    if b > 0.0:
        c = a * b
        c_dot = b * a_dot + a * b_dot
        d = np.sin(c)
        d_dot = np.cos(c) * c_dot
    elif a > 0.0:
        d = c * b
        d_dot = b * c_dot + c * b_dot
    else:
        d = 2.0
        d_dot = 0.0
    return (d * c_dot + c * d_dot,)
