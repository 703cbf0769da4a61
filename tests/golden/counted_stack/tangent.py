"""Tangent of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
"""

import numpy as np


def kernel_tangent(x, x_dot):
    state = 0.5
    state_dot = 0.0
    for i in range(x.size):
        state_1 = np.sin(state) * x[i]
        state_dot = x[i] * (np.cos(state) * state_dot) + np.sin(state) * x_dot[i]
        state = state_1
    return (state_dot,)
