"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in-out

It records nothing.
"""

import numpy as np

from s2sad.runtime import allocate_zeros  # isort: skip


def kernel_adjoint_taped(y, y_bar, x, x_bar, arena):
    """Adjoint of kernel: d(y) / d(x), in given memory."""
    # reverse sweep
    x_shadow, top = allocate_zeros(arena, 0, x.shape)
    for i in range(x.size):
        # y[i] = 3.0 * x[i]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_shadow[i] += 3.0 * seed
        # x[i] = x[i] * x[i]
        x_shadow[i] = 2.0 * (x[i] * x_shadow[i])
    for i_2 in range(x_bar.shape[0]):
        x_bar[i_2] += x_shadow[i_2]
    return (top,)


def kernel_adjoint(y, y_bar, x, x_bar):
    kernel_adjoint_taped(y, y_bar, x, x_bar, np.empty(0))
