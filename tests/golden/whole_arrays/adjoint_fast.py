"""Adjoint of kernel: d(y, return) / d(y, x, a).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], in-out
    x: float64[:], in
    a: float64, in

It records:
    y_stack: y before `y *= np.sin(x)`, 8 * y.shape[0] bytes
"""

import numpy as np

from s2sad.runtime import added, sized  # isort: skip


def kernel_adjoint_taped(y, y_bar, x, x_bar, a, result_bar, y_stack):
    """Adjoint of kernel: d(y, return) / d(y, x, a), in given memory."""
    # forward sweep: only what the reverse sweep reads
    assert y.shape == x.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    y_stack = sized(y_stack, (y.shape[0],))
    for i in range(y.shape[0]):
        y[i] = a * x[i] + y[i]
        y_stack[i] = y[i]
        y[i] = y[i] * np.sin(x[i])
    # reverse sweep
    a_bar = 0.0
    for i in range(y_bar.shape[0]):
        # return np.sum(y * y)
        y_bar[i] += 2.0 * (y[i] * result_bar)
    for i in range(y.shape[0]):
        # y *= np.sin(x)
        y[i] = y_stack[i]
        seed = y_bar[i]
        x_bar[i] += np.cos(x[i]) * (y[i] * seed)
        y_bar[i] = np.sin(x[i]) * seed
        # y[:] = a * x + y
        seed = y_bar[i]
        a_bar = added(a_bar, x[i] * seed)
        x_bar[i] += a * seed
        y_bar[i] = seed
    return a_bar, y_stack


def kernel_adjoint(y, y_bar, x, x_bar, a, result_bar):
    returned = kernel_adjoint_taped(y, y_bar, x, x_bar, a, result_bar, np.empty(0))
    return (returned[0],)
