"""Adjoint of kernel: d(x) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in-out

It records:
    taken_stack: which way `if x[i] > x[i - 1]:` went, len(range(1, x.size)) bytes
    x_stack: x before `x[i] = x[i] * x[i - 1]`, 8 * len(range(1, x.size)) bytes
"""

import numpy as np

from s2sad.runtime import sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, taken_stack, x_stack):
    """Adjoint of kernel: d(x) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    taken_stack = sized(taken_stack, (len(range(1, x.size)),))
    x_stack = sized(x_stack, (len(range(1, x.size)),))
    for i in range(1, x.size):
        taken = x[i] > x[i - 1]
        taken_stack[i - 1] = taken
        if taken:
            x_stack[i - 1] = x[i]
            x[i] = x[i] * x[i - 1]
        else:
            x[i] = 3.0 * x[i]
    # reverse sweep
    for i in range(x.size - 1, 0, -1):
        if taken_stack[i - 1]:
            # x[i] = x[i] * x[i - 1]
            x[i] = x_stack[i - 1]
            seed = x_bar[i]
            x_bar[i] = x[i - 1] * seed
            x_bar[i - 1] += x[i] * seed
        else:
            # x[i] = 3.0 * x[i]
            x_bar[i] = 3.0 * x_bar[i]
    return taken_stack, x_stack


def kernel_adjoint(x, x_bar):
    kernel_adjoint_taped(x, x_bar, np.empty(0, np.bool_), np.empty(0))
