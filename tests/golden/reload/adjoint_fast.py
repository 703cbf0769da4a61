"""Adjoint of kernel: d(a) / d(a).

Engine: Numba. Level: fast. Arguments:
    a: float64[:, :], in-out

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import math

import numpy as np


def kernel_adjoint(a, a_bar):
    # forward sweep: only what the reverse sweep reads
    for j in range(a.shape[0]):
        a[j, j] = math.sqrt(a[j, j])
        for i in range(j + 1, a.shape[0]):
            a[i, j] = a[i, j] / a[j, j]
            a_here = a[i, j]
            a[i, np.uintp(i)] -= a_here * a_here
    # reverse sweep
    for j in range(a.shape[0] - 1, -1, -1):
        for i in range(j + 1, a.shape[0]):
            # a[i, j] /= a[j, j]
            a_here = a[j, j]
            ratio = a[i, j]
            # a[i, i] -= a[i, j] * a[i, j]
            a_here_2 = a[i, j]
            a_bar[i, j] -= 2.0 * (a_here_2 * a_bar[i, np.uintp(i)] if a_here_2 != 0.0 else 0.0)
            # a[i, j] /= a[j, j]
            ratio_bar = a_bar[i, j]
            reciprocal = 1.0 / a_here
            a_bar[i, j] = ratio_bar * reciprocal if ratio_bar != 0.0 else 0.0
            a_bar[j, j] -= (
                (ratio * ratio_bar * reciprocal if ratio_bar != 0.0 else 0.0) if ratio != 0.0
                else 0.0
            )
        # a[j, j] = math.sqrt(a[j, j])
        sqrt_value_bar = a_bar[j, j]
        a_bar[j, j] = 0.5 * sqrt_value_bar / a[j, j] if sqrt_value_bar != 0.0 else 0.0
