"""Adjoint of kernel: d(return) / d(x, a).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in
    a: float64, in

It records:
    product_stack: product where an iteration of `for i in range(x.size):` begins,
        8 * x.size bytes
"""

import numpy as np

from s2sad.runtime import added, sized  # isort: skip


def kernel_adjoint_taped(x, x_bar, a, result_0_bar, result_1_bar, product_stack):
    """Adjoint of kernel: d(return 0, return 1) / d(x, a), in given memory."""
    # forward sweep: only what the reverse sweep reads
    product = a
    product_stack = sized(product_stack, (x.size,))
    for i in range(x.size):
        product_stack[i] = product
        product = product * x[i]
    # reverse sweep
    a_bar = 0.0
    # return total, product
    total_bar = result_0_bar
    product_bar = result_1_bar
    for i in range(x.size - 1, -1, -1):
        product = product_stack[i]
        # product *= x[i]
        product_bar_1 = product_bar
        product_bar = x[i] * product_bar_1
        # total += a * x[i]
        a_bar = added(a_bar, x[i] * total_bar)
        x_bar[i] += a * total_bar + product * product_bar_1
    # total, product = 0.0, a
    a_bar += product_bar
    return a_bar, product_stack


def kernel_adjoint(x, x_bar, a, result_0_bar, result_1_bar):
    returned = kernel_adjoint_taped(x, x_bar, a, result_0_bar, result_1_bar, np.empty(0))
    return (returned[0],)
