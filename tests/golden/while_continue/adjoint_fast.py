"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in

It records:
    k_stack: k where an iteration of `while k < x.size:` begins, 8 bytes per push
"""

import numpy as np

from s2sad.runtime import grow, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, result_bar, k_stack):
    """Adjoint of kernel: d(return) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    k = 0
    k_stack = sized(k_stack, (max(64, k_stack.shape[0]),))
    trips = 0
    while k < x.size:
        k_stack = grow(k_stack, trips)
        k_stack[trips] = k
        k = k + 1
        trips += 1
    # reverse sweep
    # return total
    total_bar = result_bar
    for trip in range(trips - 1, -1, -1):
        k = k_stack[trip]
        # k += 1
        k = k + 1
        if not x[k - 1] < 0.0:
            # total += x[k - 1] ** 3
            x_bar[k - 1] += 3.0 * x[k - 1] ** 2 * total_bar
    return (k_stack,)


def kernel_adjoint(x, x_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, result_bar, np.empty(0, np.int64))
