"""Tangent of kernel: d(return) / d(u, a).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in
    a: float64, in
"""

import numpy as np


def kernel_tangent(u, u_dot, a, a_dot):
    out = np.zeros_like(u)
    out_dot = np.zeros_like(out)
    for i in range(1, u.size):
        out_dot[i] = u_dot[i] - u_dot[i - 1]
        out[i] = u[i] - u[i - 1]
    slope = np.empty_like(out)
    slope_dot = np.zeros_like(slope)
    slope_dot[...] = out * a_dot + a * out_dot
    returned = np.empty(max(u.shape[0] - 1, 0))
    returned_dot = np.zeros_like(returned)
    returned_dot[...] = u_dot[1:]
    return slope_dot, returned_dot, slope_dot
