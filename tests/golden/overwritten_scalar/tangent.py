"""Tangent of kernel: d(return) / d(a, b).

Engine: NumPy. Level: plain. Arguments:
    a: float64, in
    b: float64, in
"""

import numpy as np


def kernel_tangent(a, a_dot, b, b_dot):
    z = a * b
    z_dot = b * a_dot + a * b_dot
    z_1 = np.sin(z)
    z_1_dot = np.cos(z) * z_dot
    z_2 = z_1 * z_1 + a
    z_2_dot = z_1 * z_1_dot + z_1 * z_1_dot + a_dot
    z_dot_1 = b * z_2_dot + z_2 * b_dot
    return (z_dot_1,)
