"""Adjoint of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in-out

It records:
    x_stack: x before `x[i] = x[i] * x[i]`, 8 * x.size bytes
"""

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar):
    # forward sweep: only what the reverse sweep reads
    x_stack = np.empty(x.size)
    for i in range(x.size):
        x_here = x[i]
        x_stack[i] = x[i]
        x[i] = x_here * x_here
    # reverse sweep
    x_shadow = np.zeros_like(x)
    for i in range(x.size - 1, -1, -1):
        # x[i] = x[i] * x[i]
        x[i] = x_stack[i]
        # y[i] = 3.0 * x[i]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_shadow[i] += 3.0 * seed
        # x[i] = x[i] * x[i]
        x_shadow[i] = 2.0 * (x[i] * x_shadow[i])
    x_bar[...] += x_shadow
