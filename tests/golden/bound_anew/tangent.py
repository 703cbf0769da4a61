"""Tangent of kernel: d(return) / d(u, rate).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in
    rate: float64, in
    n: int64, in
"""

import numpy as np


def kernel_tangent(u, u_dot, rate, rate_dot, n):
    before = np.empty_like(u)
    before_dot = np.zeros_like(before)
    before_dot[...] = u_dot
    before[...] = u
    u_1 = np.empty_like(u)
    u_1_dot = np.zeros_like(u_1)
    u_1_dot[...] = u_dot
    u_1[...] = u
    u_1_2 = np.empty_like(u_1)
    u_1_2_dot = np.zeros_like(u_1_2)
    for _ in range(n):
        u_1_2_dot[...] = u_1_dot - (u_1 ** 2 * rate_dot + rate * (2.0 * u_1 * u_1_dot))
        u_1_2[...] = u_1 - rate * u_1 ** 2
        before_dot[...] = u_1_dot
        before[...] = u_1
        u_1_dot[...] = u_1_2_dot
        u_1[...] = u_1_2
    returned = np.empty_like(u_1)
    returned_dot = np.zeros_like(returned)
    returned_dot[...] = before * u_1_dot + u_1 * before_dot
    return (returned_dot,)
