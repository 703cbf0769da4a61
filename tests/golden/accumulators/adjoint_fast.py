"""Adjoint of kernel: d(y) / d(y, x).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], in-out
    x: float64[:], in

It records:
    product_stack: product where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
"""

import numpy as np

from s2sad.runtime import sized  # isort: skip


def kernel_adjoint_taped(y, y_bar, x, x_bar, product_stack):
    """Adjoint of kernel: d(y) / d(y, x), in given memory."""
    # forward sweep: only what the reverse sweep reads
    total = 0.0
    product = 1.0
    product_stack = sized(product_stack, (x.size,))
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
        # total += x[i] * x[i]
        x_bar[i] += 2.0 * (x[i] * total_bar) + (product * product_bar_1 - 2.0 * y_bar[0])
    return (product_stack,)


def kernel_adjoint(y, y_bar, x, x_bar):
    kernel_adjoint_taped(y, y_bar, x, x_bar, np.empty(0))
