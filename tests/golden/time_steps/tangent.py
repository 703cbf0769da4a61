"""Tangent of kernel: d(u, return) / d(u, c).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    c: float64, in
    n: int64, in
"""

import numpy as np


def kernel_tangent(u, u_dot, c, c_dot, n):
    v = np.empty_like(u)
    v_dot = np.zeros_like(v)
    energy_dot = 0.0
    for k in range(n):
        for i in range(u.size):
            u_here = u[i]
            v_dot[i] = np.cos(u_here) * u_dot[i]
            v[i] = np.sin(u_here) + k
        u_dot[...] += v * c_dot + c * v_dot
        u[...] += c * v
        energy_dot += u[1] * u_dot[0] + u[0] * u_dot[1]
    return (energy_dot,)
