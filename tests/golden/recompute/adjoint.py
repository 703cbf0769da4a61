"""Adjoint of kernel: d(y) / d(x, scale).

Engine: NumPy. Level: plain. Arguments:
    y: float64[:], out
    x: float64[:], in
    scale: float64, in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_adjoint(y, y_bar, x, x_bar, scale):
    # forward sweep: only what the reverse sweep reads
    n = x.size
    exp_value = np.exp(scale)
    factor = exp_value / n
    # reverse sweep
    factor_bar = np.float64(0.0)
    for i in range(n - 1, -1, -1):
        last = n - 1 - i
        bent = np.sin(x[last]) * factor
        # y[i] = bent * bent
        seed = y_bar[i]
        y_bar[i] = 0.0
        bent_bar = 2.0 * (bent * seed)
        # bent = math.sin(x[last]) * factor
        x_bar[last] += np.cos(x[last]) * (factor * bent_bar)
        factor_bar += np.sin(x[last]) * bent_bar
    # factor = math.exp(scale) / n
    exp_value_bar = factor_bar / n if factor_bar != 0.0 else 0.0
    scale_bar = exp_value * exp_value_bar if exp_value_bar != 0.0 else 0.0
    return (scale_bar,)
