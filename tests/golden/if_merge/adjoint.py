"""Adjoint of kernel: d(return) / d(a, b).

Engine: NumPy. Level: plain. Arguments:
    a: float64, in
    b: float64, in

It records nothing.
"""

import numpy as np


def kernel_adjoint(a, b, result_bar):
    # forward sweep: only what the reverse sweep reads
    c = a
    taken = b > 0.0
    if taken:
        c_1 = a * b
        d = np.sin(c_1)
        c_2 = c_1
    else:
        taken_2 = a > 0.0
        if taken_2:
            d = c * b
        else:
            d = 2.0
        c_2 = c
    # reverse sweep
    a_bar = 0.0
    b_bar = 0.0
    c_bar = 0.0
    # return c * d
    c_1_bar = d * result_bar
    d_bar = c_2 * result_bar
    if taken:
        # d = math.sin(c)
        c_1_bar += np.cos(c_1) * d_bar
        # c = a * b
        a_bar += b * c_1_bar
        b_bar += a * c_1_bar
    else:
        c_bar += c_1_bar
        if taken_2:
            # d = c * b
            c_bar += b * d_bar
            b_bar += c * d_bar
    # c = a
    a_bar += c_bar
    return a_bar, b_bar
