"""Adjoint of kernel: d(y) / d(x).

Engine: Numba. Level: fast. Arguments:
    y: float32[:], out
    x: float32[:], in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import math

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar):
    # reverse sweep
    for i in range(x.size):
        half = np.float32(0.5) * x[i]
        # y[i] = half * math.exp(half)
        exp_value = math.exp(half)
        seed = y_bar[i]
        y_bar[i] = 0.0
        half_bar = exp_value * seed
        exp_value_bar = half * seed
        half_bar += exp_value * exp_value_bar if exp_value_bar != 0.0 else 0.0
        # half = np.float32(0.5) * x[i]
        x_bar[i] += np.float32(0.5) * half_bar
