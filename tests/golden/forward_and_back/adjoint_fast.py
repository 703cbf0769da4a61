"""Adjoint of kernel: d(return) / d(x, scales).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in
    scales: float64[:], in

It records nothing.
"""

# ruff: noqa: PLR1730, RUF100

import math

import numpy as np

from s2sad.runtime import added, allocate, allocate_zeros  # isort: skip


def kernel_adjoint_taped(x, x_bar, scales, scales_bar, result_bar, arena):
    """Adjoint of kernel: d(return) / d(x, scales), in given memory."""
    # forward sweep: only what the reverse sweep reads
    work, top = allocate(arena, 0, (scales.size,))
    # reverse sweep
    work_bar, top = allocate_zeros(arena, top, work.shape)
    # return total
    total_bar = result_bar
    for i in range(x.size - 1, -1, -1):
        for k in range(scales.size):
            work[k] = math.sin(scales[k] * x[i])
        for k in range(scales.size):
            # total += work[k] * work[k]
            work_bar[k] += 2.0 * (work[k] * total_bar)
        if 0 < scales.size:
            x_bar_total = x_bar[i]
            for k in range(scales.size):
                # work[k] = math.sin(scales[k] * x[i])
                seed = work_bar[k]
                work_bar[k] = 0.0
                seed = np.cos(scales[k] * x[i]) * seed
                scales_bar[k] += x[i] * seed
                x_bar_total = added(x_bar_total, scales[k] * seed)
            # work[k] = math.sin(scales[k] * x[i])
            x_bar[i] = x_bar_total
    return (top,)


def kernel_adjoint(x, x_bar, scales, scales_bar, result_bar):
    kernel_adjoint_taped(x, x_bar, scales, scales_bar, result_bar, np.empty(0))
