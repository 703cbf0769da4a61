"""Adjoint of kernel: d(return) / d(a, b).

Engine: Numba. Level: fast. Arguments:
    a: float64, in
    b: float64, in
    n: int64, in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_adjoint(a, b, n, result_bar):
    # forward sweep: only what the reverse sweep reads
    power = b ** -1.5
    # reverse sweep
    # return a ** 2 + a ** 3 * b ** -1.5 + b ** a + 2.0 ** a + a ** n + a ** 0.5
    a_bar = 2.0 * a * result_bar + 3.0 * a ** 2 * (power * result_bar)
    power_bar = a ** 3 * result_bar
    a_bar += 0.5 * result_bar / a ** 0.5 if result_bar != 0.0 else 0.0
    a_bar += (0.0 if n == 0 else n * a ** (n - 1) * result_bar) if result_bar != 0.0 else 0.0
    a_bar += 2.0 ** a * np.log(2.0) * result_bar if result_bar != 0.0 else 0.0
    b_bar = (0.0 if a == 0 else a * b ** (a - 1) * result_bar) if result_bar != 0.0 else 0.0
    a_bar += b ** a * np.log(1.0 if b == 0 else b) * result_bar if result_bar != 0.0 else 0.0
    b_bar -= 1.5 * power * power_bar / b if power_bar != 0.0 else 0.0
    return a_bar, b_bar
