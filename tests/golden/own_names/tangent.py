"""Tangent of kernel: d(return) / d(u, seed).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in
    seed: float64, in
"""

import numpy as np_


def kernel_tangent(u, u_dot, seed, seed_dot):
    u_bar = np_.sin(u[0])
    u_bar_dot = np_.cos(u[0]) * u_dot[0]
    for np in range(1, u.size):
        u_bar_1 = u_bar * u[np] * seed
        u_bar_dot = seed * (u[np] * u_bar_dot + u_bar * u_dot[np]) + u_bar * u[np] * seed_dot
        u_bar = u_bar_1
    return (u_bar_dot,)
