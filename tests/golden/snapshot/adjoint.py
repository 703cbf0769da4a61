"""Adjoint of kernel: d(u) / d(u).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    dt: float64, in
    steps: int64, in

It records:
    u_stack: u before `u += dt * du`, 8 * len(range(steps)) * u.size bytes
"""

import numpy as np


def kernel_adjoint(u, u_bar, dt, steps):
    # forward sweep: only what the reverse sweep reads
    du = np.empty_like(u)
    u_stack = np.empty((len(range(steps)),) + u.shape)
    for _ in range(steps):
        for i in range(u.size):
            du[i] = u[i - 1] * u[i]
        u_stack[_] = u
        u[...] += dt * du
    # reverse sweep
    du_bar = np.zeros_like(du)
    for _ in range(steps - 1, -1, -1):
        # u += dt * du
        u[...] = u_stack[_]
        du_bar[...] += dt * u_bar
        for i in range(u.size - 1, -1, -1):
            # du[i] = u[i - 1] * u[i]
            seed = du_bar[i]
            du_bar[i] = 0.0
            u_bar[i] += u[i - 1] * seed
            u_bar[i - 1] += u[i] * seed
