"""Tangent of kernel: d(return) / d(a, b).

Engine: NumPy. Level: plain. Arguments:
    a: float64, in
    b: float64, in
    n: int64, in
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_tangent(a, a_dot, b, b_dot, n):
    a = np.float64(a)
    b = np.float64(b)
    power = b ** -1.5
    return (
        2.0 * a * a_dot + (
            power * (3.0 * a ** 2 * a_dot) -
            a ** 3 * (1.5 * power * b_dot / b if b_dot != 0.0 else 0.0)
        ) + (
            ((0.0 if a == 0 else a * b ** (a - 1) * b_dot) if b_dot != 0.0 else 0.0) +
            (b ** a * np.log(1.0 if b == 0 else b) * a_dot if a_dot != 0.0 else 0.0)
        ) + (2.0 ** a * np.log(2.0) * a_dot if a_dot != 0.0 else 0.0) +
        ((0.0 if n == 0 else n * a ** (n - 1) * a_dot) if a_dot != 0.0 else 0.0) +
        (0.5 * a_dot / a ** 0.5 if a_dot != 0.0 else 0.0),
    )
