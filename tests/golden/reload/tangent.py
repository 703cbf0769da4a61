"""Tangent of kernel: d(a) / d(a).

Engine: NumPy. Level: plain. Arguments:
    a: float64[:, :], in-out
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_tangent(a, a_dot):
    for j in range(a.shape[0]):
        a_here_dot = a_dot[j, j]
        sqrt_value = np.sqrt(a[j, j])
        a_dot[j, j] = 0.5 * a_here_dot / sqrt_value if a_here_dot != 0.0 else 0.0
        a[j, j] = sqrt_value
        for i in range(j + 1, a.shape[0]):
            a_here_2_dot = a_dot[i, j]
            a_here = a[j, j]
            a_here_3_dot = a_dot[j, j]
            ratio = a[i, j] / a_here
            slope = -ratio / a_here
            a_dot[i, j] = (
                (a_here_2_dot / a_here if a_here_2_dot != 0.0 else 0.0) +
                ((slope * a_here_3_dot if a_here_3_dot != 0.0 else 0.0) if slope != 0.0 else 0.0)
            )
            a[i, j] = ratio
            a_here = a[i, j]
            a_here_4_dot = a_dot[i, j]
            a_dot[i, i] -= (
                (a_here * a_here_4_dot if a_here != 0.0 else 0.0) +
                (a_here * a_here_4_dot if a_here != 0.0 else 0.0)
            )
            a[i, i] -= a_here * a_here
