"""Adjoint of kernel: d(y) / d(x, top).

Engine: Numba. Level: fast. Arguments:
    y: float64[:], out
    x: float64[:], in
    top: float64, in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import numpy as np

from s2sad.runtime import added  # isort: skip


def kernel_adjoint(y, y_bar, x, x_bar, top):
    # reverse sweep
    top_bar = 0.0
    for i in range(x.size):
        # y[i] = min(max(x[i], 0.1), top) * abs(x[i])
        taken = top < max(x[i], 0.1)
        seed = y_bar[i]
        y_bar[i] = 0.0
        seed_2 = abs(x[i]) * seed
        x_bar[i] += (
            (0.0 if 0.1 > x[i] else 0.0 if taken else seed_2) +
            np.sign(x[i]) * (min(max(x[i], 0.1), top) * seed)
        )
        top_bar = added(top_bar, seed_2 if taken else 0.0)
    return (top_bar,)
