"""Adjoint of kernel: d(return) / d(x, scales).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in
    scales: float64[:], in

It records:
    work_stack: work before `work[0] = scales[0] * x[i]`, 8 * x.size bytes
    work_stack_2: work before `work[k] = math.sin(work[k - 1]) * scales[k]`, 8 * x.size *
        len(range(1, scales.size)) bytes
"""

import math

import numpy as np

from s2sad.runtime import sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, scales, scales_bar, result_bar, work_stack, work_stack_2):
    # forward sweep: only what the reverse sweep reads
    work = np.empty(scales.size)
    work_stack = sized(work_stack, (x.size,))
    work_stack_2 = sized(work_stack_2, (x.size, len(range(1, scales.size))))
    for i in range(x.size):
        work_stack[i] = work[0]
        work[0] = scales[0] * x[i]
        for k in range(1, scales.size):
            work_here = work[k - 1]
            work_stack_2[i, k - 1] = work[k]
            work[k] = math.sin(work_here) * scales[k]
    # reverse sweep
    work_bar = np.zeros_like(work)
    # return total
    total_1_bar = result_bar
    for i in range(x.size - 1, -1, -1):
        # total += work[scales.size - 1] ** 2
        work_bar[scales.size - 1] += 2.0 * work[scales.size - 1] * total_1_bar
        for k in range(scales.size - 1, 0, -1):
            # work[k] = math.sin(work[k - 1]) * scales[k]
            work[k] = work_stack_2[i, k - 1]
            work_here = work[k - 1]
            seed = work_bar[k]
            work_bar[k] = 0.0
            scales_bar[k] += math.sin(work_here) * seed
            work_bar[k - 1] += np.cos(work_here) * (scales[k] * seed)
        # work[0] = scales[0] * x[i]
        work[0] = work_stack[i]
        seed = work_bar[0]
        work_bar[0] = 0.0
        scales_bar[0] += x[i] * seed
        x_bar[i] += scales[0] * seed
    return work_stack, work_stack_2


def kernel_adjoint(x, x_bar, scales, scales_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, scales, scales_bar, result_bar, np.empty(0), np.empty((0, 0)))
