"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in-out

It records:
    x_stack: x before `x[i] = x[i] * x[i]`, 8 * x.size bytes
"""

import numpy as np

from s2sad.runtime import sized  # isort: skip


def kernel_adjoint_taped(y, y_bar, x, x_bar, x_stack):
    """Adjoint of kernel: d(y) / d(x), over given stacks."""
    # forward sweep: only what the reverse sweep reads
    x_stack = sized(x_stack, (x.size,))
    for i in range(x.size):
        x_here = x[i]
        x_stack[i] = x[i]
        x[i] = x_here * x_here
    # reverse sweep
    x_shadow = np.zeros_like(x)
    for i in range(x.size):
        # x[i] = x[i] * x[i]
        x[i] = x_stack[i]
        # y[i] = 3.0 * x[i]
        seed = y_bar[i]
        y_bar[i] = 0.0
        x_shadow[i] += 3.0 * seed
        # x[i] = x[i] * x[i]
        x_shadow[i] = 2.0 * (x[i] * x_shadow[i])
    for i_2 in range(x_bar.shape[0]):
        x_bar[i_2] += x_shadow[i_2]
    return (x_stack,)


def kernel_adjoint(y, y_bar, x, x_bar):
    kernel_adjoint_taped(y, y_bar, x, x_bar, np.empty(0))
