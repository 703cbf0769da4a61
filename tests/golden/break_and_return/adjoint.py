"""Adjoint of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
    limit: float64, in

It records:
    total_stack: total where an iteration of `for i in range(x.size):` begins, 8 bytes per
        push
"""

# ruff: noqa: PLR1730, SIM113, RUF100

import numpy as np

from s2sad.runtime import grow  # isort: skip


def kernel_adjoint(x, x_bar, limit, result_bar):
    # forward sweep: only what the reverse sweep reads
    total = 1.0
    returned = False
    total_stack = np.empty(64)
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
    result_bar_1 = 0.0
    total_bar = 0.0
    # return total * total
    result_bar_2 = result_bar
    if not returned:
        total_bar += 2.0 * (total * result_bar_2)
    else:
        result_bar_1 += result_bar_2
    for i in range(trips - 1, -1, -1):
        total = total_stack[i]
        if x[i] < 0.0:
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
