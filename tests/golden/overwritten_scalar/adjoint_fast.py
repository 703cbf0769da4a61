"""Adjoint of kernel: d(return) / d(a, b).

Engine: Numba. Level: fast. Arguments:
    a: float64, in
    b: float64, in

It records nothing.
"""

import math

import numpy as np


def kernel_adjoint(a, b, result_bar):
    # forward sweep: only what the reverse sweep reads
    z = a * b
    z_1 = math.sin(z)
    z_2 = z_1 * z_1 + a
    # reverse sweep
    # return z
    z_bar = result_bar
    # z *= b
    z_2_bar = b * z_bar
    b_bar = z_2 * z_bar
    # z = z * z + a
    z_1_bar = 2.0 * (z_1 * z_2_bar)
    a_bar = z_2_bar
    # z = math.sin(z)
    z_bar_1 = np.cos(z) * z_1_bar
    # z = a * b
    a_bar += b * z_bar_1
    b_bar += a * z_bar_1
    return a_bar, b_bar
