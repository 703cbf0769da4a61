"""Tangent of kernel: d(y, return) / d(y, x, a).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in
    a: float64, in
"""

import numpy as np


def kernel_tangent(y, y_dot, x, x_dot, a, a_dot):
    assert y.shape == x.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    y_dot[...] = x * a_dot + a * x_dot + y_dot
    y[...] = a * x + y
    y_dot[...] = np.sin(x) * y_dot + y * (np.cos(x) * x_dot)
    y[...] = y * np.sin(x)
    return (np.sum(y * y_dot + y * y_dot),)
