"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in-out

It records nothing.
"""

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    x_shadow = np.zeros_like(x)
    for i in range(x.size):
        # y[i] = 3.0 * x[i]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_shadow[i] += 3.0 * seed
        # x[i] = x[i] * x[i]
        x_shadow[i] = 2.0 * (x[i] * x_shadow[i])
    for i_2 in range(x_bar.shape[0]):
        x_bar[i_2] += x_shadow[i_2]
