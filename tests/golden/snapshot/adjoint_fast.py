"""Adjoint of kernel: d(u) / d(u).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in-out
    dt: float64, in
    steps: int64, in

It records:
    u_stack: u before `u += dt * du`, 8 * len(range(steps)) * u.shape[0] bytes
"""

import numpy as np

from s2sad.runtime import allocate, allocate_zeros, sized  # isort: skip


def kernel_adjoint_taped(u, u_bar, dt, steps, u_stack, arena):
    """Adjoint of kernel: d(u) / d(u), in given memory."""
    # forward sweep: only what the reverse sweep reads
    du, top = allocate(arena, 0, u.shape)
    u_stack = sized(u_stack, (len(range(steps)), u.shape[0]))
    for _ in range(steps):
        for i in range(u.size):
            du[i] = u[i - 1] * u[i]
        for i_2 in range(u.shape[0]):
            u_stack[_, i_2] = u[i_2]
            u[i_2] += dt * du[i_2]
    # reverse sweep
    du_bar, top = allocate_zeros(arena, top, u.shape)
    for _ in range(steps - 1, -1, -1):
        for i_2 in range(u.shape[0]):
            # u += dt * du
            u[i_2] = u_stack[_, i_2]
            du_bar[i_2] += dt * u_bar[i_2]
        for i in range(u.size):
            # du[i] = u[i - 1] * u[i]
            seed = du_bar[i]
            du_bar[i] = 0.0
            u_bar[i] += u[i - 1] * seed
            u_bar[i - 1] += u[i] * seed
    return u_stack, top


def kernel_adjoint(u, u_bar, dt, steps):
    kernel_adjoint_taped(u, u_bar, dt, steps, np.empty((0, 0)), np.empty(0))
