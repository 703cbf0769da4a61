"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in

It records:
    total_stack: total where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
    part_stack: part where an iteration of `for _ in range(i + 1):` begins, 8 bytes per push
"""

import math

import numpy as np

from s2sad.runtime import grow, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, result_bar, total_stack, part_stack):
    """Adjoint of kernel: d(return) / d(x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    total = 1.0
    total_stack = sized(total_stack, (x.size,))
    for i in range(x.size):
        total_stack[i] = total
        part = x[i]
        for _ in range(i + 1):
            part = part * math.cos(part)
        total = total * part
    # reverse sweep
    # return total
    total_bar = result_bar
    part_stack = sized(part_stack, (max(64, part_stack.shape[0]),))
    for i in range(x.size - 1, -1, -1):
        part = x[i]
        part_stack = grow(part_stack, len(range(i + 1)) - 1)
        for _ in range(i + 1):
            part_stack[_] = part
            part = part * math.cos(part)
        total = total_stack[i]
        # total = total * part
        total_bar_1 = total_bar
        total_bar = part * total_bar_1
        part_bar = total * total_bar_1
        for _ in range(i, -1, -1):
            part = part_stack[_]
            # part = part * math.cos(part)
            part_bar = math.cos(part) * part_bar - np.sin(part) * (part * part_bar)
        # part = x[i]
        x_bar[i] += part_bar
    return total_stack, part_stack


def kernel_adjoint(x, x_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, result_bar, np.empty(0), np.empty(0))
