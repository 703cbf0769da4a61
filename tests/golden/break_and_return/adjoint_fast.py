"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in
    limit: float64, in

It records:
    total_stack: total where an iteration of `for i in range(x.size):` begins, 8 bytes per
        push
"""

# ruff: noqa: PLR1730, SIM113, RUF100

import numpy as np

from s2sad.runtime import grow, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, limit, result_bar, total_stack):
    """Adjoint of kernel: d(return) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    total = 1.0
    returned = False
    total_stack = sized(total_stack, (max(64, total_stack.shape[0]),))
    trips = 0
    for i in range(x.size):
        total_stack = grow(total_stack, i)
        total_stack[i] = total
        trips += 1
        if x[i] < 0.0:
            returned = True
            break
        else:
            total_1 = total * x[i]
            if total_1 > limit:
                total = total_1
                break
            else:
                total = total_1
    # reverse sweep
    # return total * total
    result_bar_2 = result_bar
    total_bar = 2.0 * (total * result_bar_2) if not returned else 0.0
    result_bar_1 = 0.0 if not returned else result_bar_2
    for i in range(trips - 1, -1, -1):
        total = total_stack[i]
        taken = x[i] < 0.0
        if taken:
            # return total * x[i]
            result_bar_3 = result_bar_1
            result_bar_1 = 0.0
            total_bar += x[i] * result_bar_3
            x_bar[i] += total * result_bar_3
        else:
            total_1_bar = total_bar
            # total = total * x[i]
            total_bar = x[i] * total_1_bar
            x_bar[i] += total * total_1_bar
    return (total_stack,)


def kernel_adjoint(x, x_bar, limit, result_bar):
    kernel_adjoint_taped(x, x_bar, limit, result_bar, np.empty(0))
