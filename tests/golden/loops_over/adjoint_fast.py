"""Adjoint of kernel: d(y, return) / d(x, y).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in
    y: float64[:], in-out

It records:
    total_stack: total where an iteration of `for i in reversed(range(1,
        x.size)):` begins, 8 * len(range(x.size - 1, 0, -1)) bytes
"""

import numpy as np

from s2sad.runtime import added, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, y, y_bar, result_bar, total_stack):
    """Adjoint of kernel: d(y, return) / d(x, y), in given memory."""
    # forward sweep: only what the reverse sweep reads
    total = 0.0
    for index in range(min(len(x), len(y))):
        value = x[index]
        other = y[index]
        total += value * other
    total_1 = total
    total_stack = sized(total_stack, (len(range(x.size - 1, 0, -1)),))
    for i in range(x.size - 1, 0, -1):
        total_stack[np.uintp(x.size - 1 - i)] = total_1
        total_1 = total_1 * x[i]
    # reverse sweep
    # return total
    total_bar = result_bar
    for i in range(1, x.size):
        total_1 = total_stack[np.uintp(x.size - 1 - i)]
        # total *= x[i]
        total_1_bar = total_bar
        total_bar = x[i] * total_1_bar
        x_bar[i] += total_1 * total_1_bar
    for k in range(len(x)):
        value_1 = x[k]
        # y[k] = total * value
        seed = y_bar[k]
        y_bar[k] = 0.0
        total_bar = added(total_bar, value_1 * seed)
        value_1_bar = total * seed
        x_bar[k] += value_1_bar
    for index in range(min(len(x), len(y))):
        value = x[index]
        other = y[index]
        # total += value * other
        value_bar = other * total_bar
        other_bar = value * total_bar
        y_bar[index] += other_bar
        x_bar[index] += value_bar
    return (total_stack,)


def kernel_adjoint(x, x_bar, y, y_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, y, y_bar, result_bar, np.empty(0))
