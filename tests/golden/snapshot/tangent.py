"""Tangent of kernel: d(u) / d(u).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    dt: float64, in
    steps: int64, in
"""

import numpy as np


def kernel_tangent(u, u_dot, dt, steps):
    du = np.empty_like(u)
    du_dot = np.zeros_like(du)
    for _ in range(steps):
        for i in range(u.size):
            u_here = u[i - 1]
            u_here_2 = u[i]
            du_dot[i] = u_here_2 * u_dot[i - 1] + u_here * u_dot[i]
            du[i] = u_here * u_here_2
        u_dot[...] += dt * du_dot
        u[...] += dt * du
