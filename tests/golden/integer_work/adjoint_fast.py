"""Adjoint of kernel: d(y) / d(y, x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar):
    # forward sweep: only what the reverse sweep reads
    order = np.zeros(x.size, np.int64)
    flags = np.zeros(x.size, np.bool_)
    for i in range(x.size):
        order[i] = x.size - 1 - i
        flags[i] = x[i] > 0.0
    # reverse sweep
    for i in range(x.size):
        if flags[order[i]]:
            # y[i] = x[order[i]] * x[i]
            place = order[i]
            seed = y_bar[i]
            y_bar[i] = 0.0
            x_bar[place] += x[i] * seed
            x_bar[i] += x[place] * seed
