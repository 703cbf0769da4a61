"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in

It records:
    k_1_stack: k where an iteration of `while k < x.size:` begins, 8 bytes per push
"""

# ruff: noqa: SIM113, RUF100

import numpy as np

from s2sad.runtime import grow, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, result_bar, k_1_stack):
    # forward sweep: only what the reverse sweep reads
    k = 0
    k_1_stack = sized(k_1_stack, (max(64, k_1_stack.shape[0]),))
    k_1_top = 0
    trips = 0
    while k < x.size:
        trips += 1
        k_1_stack = grow(k_1_stack, k_1_top)
        k_1_stack[k_1_top] = k
        k_1_top += 1
        k = k + 1
    # reverse sweep
    # return total
    total_bar = result_bar
    for trip in range(trips):
        k_1_top -= 1
        k = k_1_stack[k_1_top]
        # k += 1
        k = k + 1
        if not x[k - 1] < 0.0:
            # total += x[k - 1] ** 3
            x_bar[k - 1] += 3.0 * x[k - 1] ** 2 * total_bar
    return (k_1_stack,)


def kernel_adjoint(x, x_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, result_bar, np.empty(0, np.int64))
