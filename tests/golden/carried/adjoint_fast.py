"""Adjoint of kernel: d(u, return) / d(u, c).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in-out
    c: float64, in

It records:
    u_stack: u before `u[i] = here - c * here * (here - left)`, 8 * u.size bytes
"""

# ruff: noqa: FURB136, RUF100

import numpy as np

from s2sad.runtime import added, sized  # isort: skip


def kernel_adjoint_taped(u, u_bar, c, result_bar, u_stack):
    """Adjoint of kernel: d(u, return) / d(u, c), in given memory."""
    # forward sweep: only what the reverse sweep reads
    left = u[u.size - 1]
    left_1 = left
    u_stack = sized(u_stack, (u.size,))
    for i in range(u.size):
        here = u[i]
        u_stack[i] = u[i]
        u[i] = here - c * here * (here - left_1)
        left_1 = here
    # reverse sweep
    c_bar = 0.0
    left_bar = 0.0
    # return total
    total_bar = result_bar
    for i in range(u.size):
        # total += u[i] * u[i]
        u_bar[i] += 2.0 * (u[i] * total_bar)
    for i in range(u.size - 1, -1, -1):
        left_1 = u_stack[i - 1] if i > 0 else left
        # u[i] = here - c * here * (here - left)
        u[i] = u_stack[i]
        here = u[i]
        # left = here
        here_bar = left_bar
        # u[i] = here - c * here * (here - left)
        seed = u_bar[i]
        seed_2 = (here - left_1) * seed
        seed_3 = c * here * seed
        here_bar += seed - c * seed_2 - seed_3
        c_bar = added(c_bar, -(here * seed_2))
        left_bar = seed_3
        # here = u[i]
        u_bar[i] = here_bar
    # left = u[u.size - 1]
    u_bar[u.size - 1] += left_bar
    return c_bar, u_stack


def kernel_adjoint(u, u_bar, c, result_bar):
    returned = kernel_adjoint_taped(u, u_bar, c, result_bar, np.empty(0))
    return (returned[0],)
