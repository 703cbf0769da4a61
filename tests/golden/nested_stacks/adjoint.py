"""Adjoint of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in

It records:
    total_stack: total where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
    part_stack: part where an iteration of `for _ in range(i + 1):` begins, 8 bytes per push
"""

import numpy as np

from s2sad.runtime import grow  # isort: skip


def kernel_adjoint(x, x_bar, result_bar):
    # forward sweep: only what the reverse sweep reads
    total = 1.0
    total_stack = np.empty(x.size)
    for i in range(x.size):
        total_stack[i] = total
        part = x[i]
        for _ in range(i + 1):
            part = part * np.cos(part)
        total = total * part
    # reverse sweep
    # return total
    total_bar = result_bar
    part_stack = np.empty(64)
    for i in range(x.size - 1, -1, -1):
        part = x[i]
        part_stack = grow(part_stack, len(range(i + 1)) - 1)
        for _ in range(i + 1):
            part_stack[_] = part
            part = part * np.cos(part)
        total = total_stack[i]
        # total = total * part
        total_bar_1 = total_bar
        total_bar = part * total_bar_1
        part_bar = total * total_bar_1
        for _ in range(i, -1, -1):
            part = part_stack[_]
            # part = part * math.cos(part)
            part_bar = np.cos(part) * part_bar - np.sin(part) * (part * part_bar)
        # part = x[i]
        x_bar[i] += part_bar
