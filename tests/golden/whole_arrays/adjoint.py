"""Adjoint of kernel: d(y, return) / d(y, x, a).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], in-out
    x: float64[:], in
    a: float64, in

It records:
    y_before: y before `y *= np.sin(x)`, 8 * y.size bytes
"""

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar, a, result_bar):
    # forward sweep: only what the reverse sweep reads
    assert y.shape == x.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    y[...] = a * x + y
    y_before = np.copy(y)
    y[...] = y * np.sin(x)
    # reverse sweep
    # return np.sum(y * y)
    y_bar[...] += 2.0 * (y * result_bar)
    # y *= np.sin(x)
    y[...] = y_before
    seed = np.copy(y_bar)
    y_bar[...] = np.sin(x) * seed
    x_bar[...] += np.cos(x) * (y * seed)
    # y[:] = a * x + y
    seed_2 = np.copy(y_bar)
    a_bar = np.sum(x * seed_2)
    x_bar[...] += a * seed_2
    return (a_bar,)
