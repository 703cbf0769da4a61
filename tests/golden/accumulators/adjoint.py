"""Adjoint of kernel: d(y) / d(y, x).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in

It records:
    product_stack: product where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
"""

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar):
    # forward sweep: only what the reverse sweep reads
    total = 0.0
    product = 1.0
    product_stack = np.empty(x.size)
    for i in range(x.size):
        product_stack[i] = product
        total += x[i] * x[i]
        product = product * x[i]
    # reverse sweep
    # y[1] = total * product
    seed = y_bar[1]
    y_bar[1] = 0.0
    total_bar = product * seed
    product_bar = total * seed
    for i in range(x.size - 1, -1, -1):
        product = product_stack[i]
        # product *= x[i]
        product_bar_1 = product_bar
        product_bar = x[i] * product_bar_1
        x_bar[i] += product * product_bar_1
        # y[0] -= 2.0 * x[i]
        x_bar[i] -= 2.0 * y_bar[0]
        # total += x[i] * x[i]
        x_bar[i] += 2.0 * (x[i] * total_bar)
