"""Adjoint of kernel: d(x) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:, :], in-out

It records:
    x_stack: x before `row[j] = row[j] * above[j]`,
        8 * len(range(1, x.shape[0])) * x.shape[1] bytes
"""

import numpy as np

from s2sad.runtime import sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, x_stack):
    """Adjoint of kernel: d(x) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    x_stack = sized(x_stack, (len(range(1, x.shape[0])), x.shape[1]))
    for i in range(1, x.shape[0]):
        for j in range(x.shape[1]):
            x_stack[i - 1, j] = x[i, j]
            x[i, j] = x[i, j] * x[i - 1, j]
    # reverse sweep
    for i in range(x.shape[0] - 1, 0, -1):
        for j in range(x.shape[1]):
            # row[j] = row[j] * above[j]
            x[i, j] = x_stack[i - 1, j]
            seed = x_bar[i, j]
            x_bar[i, j] = x[i - 1, j] * seed
            x_bar[i - 1, j] += x[i, j] * seed
    return (x_stack,)


def kernel_adjoint(x, x_bar):
    kernel_adjoint_taped(x, x_bar, np.empty((0, 0)))
