"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in
    limit: float64, in

It records:
    total_1_stack: total where an iteration of `for i in range(x.size):` begins, 8 bytes per
        push
"""

# ruff: noqa: RUF034, SIM113, SIM210, SIM211, RUF100

import numpy as np

from s2sad.runtime import grow, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, limit, result_bar, total_1_stack):
    # forward sweep: only what the reverse sweep reads
    total = 1.0
    returned = False
    total_1_stack = sized(total_1_stack, (max(64, total_1_stack.shape[0]),))
    total_1_top = 0
    trips = 0
    for i in range(x.size):
        trips += 1
        total_1_stack = grow(total_1_stack, total_1_top)
        total_1_stack[total_1_top] = total
        total_1_top += 1
        taken = x[i] < 0.0
        if taken:
            returned = True
            break
        else:
            total_1 = total * x[i]
            taken = total_1 > limit
            if taken:
                total = total_1
                break
            else:
                total = total_1
    # reverse sweep
    # return total * total
    result_3_bar = result_bar
    total_bar = total * result_3_bar + total * result_3_bar if not returned else 0.0
    result_1_bar = 0.0 if not returned else result_3_bar
    for i in range(trips - 1, -1, -1):
        # for i in range(x.size):
        total_1_top -= 1
        total = total_1_stack[total_1_top]
        # if x[i] < 0.0:
        taken = x[i] < 0.0
        if taken:
            # return total * x[i]
            result_2_bar = result_1_bar
            result_1_bar = 0.0
            total_bar += x[i] * result_2_bar
            x_bar[i] += total * result_2_bar
        else:
            # total = total * x[i]
            total_1 = total * x[i]
            # if total > limit:
            taken = total_1 > limit
            # break
            total_1_bar = total_bar if taken else total_bar
            total_bar = 0.0 if taken else 0.0
            # total = total * x[i]
            total_bar += x[i] * total_1_bar
            x_bar[i] += total * total_1_bar
    return total_1_stack,


def kernel_adjoint(x, x_bar, limit, result_bar):
    kernel_adjoint_taped(x, x_bar, limit, result_bar, np.empty(0))
