"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in

It records nothing.
"""

import numpy as np

from s2sad.runtime import allocate, allocate_zeros  # isort: skip


def kernel_adjoint_taped(y, y_bar, x, x_bar, arena):
    """Adjoint of kernel: d(y) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    work, top = allocate(arena, 0, (2,))
    # reverse sweep
    work_bar, top = allocate_zeros(arena, top, (2,))
    for i in range(x.size - 1, -1, -1):
        for i_2 in range(2):
            # work = np.zeros(2)
            work[i_2] = 0.0
        work[0] = x[i] * x[i]
        # y[i] = work[0] + work[1]
        seed = y_bar[i]
        y_bar[i] = 0.0
        work_bar[1] += seed
        work_bar[0] += seed
        # work[1] = work[0] * x[i]
        seed = work_bar[1]
        work_bar[1] = 0.0
        work_bar[0] += x[i] * seed
        # work[0] = x[i] * x[i]
        seed_2 = work_bar[0]
        work_bar[0] = 0.0
        x_bar[i] += 2.0 * (x[i] * seed_2) + work[0] * seed
        for i_2 in range(2):
            # work = np.zeros(2)
            work_bar[i_2] = 0.0
    return (top,)


def kernel_adjoint(y, y_bar, x, x_bar):
    kernel_adjoint_taped(y, y_bar, x, x_bar, np.empty(0))
