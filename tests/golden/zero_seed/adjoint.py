"""Adjoint of kernel: d(y) / d(x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    for i in range(x.size - 1, -1, -1):
        root_bar = 0.0
        root = np.sqrt(x[i])
        if x[i] > 0.0:
            # y[i] = root if x[i] > 0.0 else 0.0
            seed = y_bar[i]
            y_bar[i] = 0.0
            root_bar += seed
        else:
            # y[i] = root if x[i] > 0.0 else 0.0
            y_bar[i] = 0.0
        # root = math.sqrt(x[i])
        x_bar[i] += 0.5 * root_bar / root if root_bar != 0.0 else 0.0
