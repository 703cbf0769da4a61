"""Adjoint of kernel: d(u) / d(u, p).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in-out
    p: float64[:], in

It records:
    u_stack: u before `u[i] = a * u[i] * u[i] + b / c`, 8 * u.size bytes
"""

# ruff: noqa: FURB136, RUF100

import numpy as np

from s2sad.runtime import added, sized  # isort: skip


def kernel_adjoint_taped(u, u_bar, p, p_bar, u_stack):
    """Adjoint of kernel: d(u) / d(u, p), over given stacks."""
    # forward sweep: only what the reverse sweep reads
    a = p[0]
    b = p[1]
    c = p[2]
    u_stack = sized(u_stack, (u.size,))
    for i in range(u.size):
        u_here = u[i]
        u_stack[i] = u[i]
        u[i] = a * u_here * u_here + b / c
    # reverse sweep
    a_bar = 0.0
    b_bar = 0.0
    c_bar = 0.0
    reciprocal = 1.0 / c
    for i in range(u.size):
        # u[i] = a * u[i] * u[i] + b / c
        u[i] = u_stack[i]
        u_here = u[i]
        seed = u_bar[i]
        seed_2 = u_here * seed
        a_bar = added(a_bar, u_here * seed_2)
        b_bar = added(b_bar, seed * reciprocal if seed != 0.0 else 0.0)
        c_bar = added(c_bar, -(b * reciprocal * seed * reciprocal if seed != 0.0 else 0.0))
        u_bar[i] = a * seed_2 + a * u_here * seed
    # a, b, c = p
    p_bar[2] += c_bar
    p_bar[1] += b_bar
    p_bar[0] += a_bar
    return (u_stack,)


def kernel_adjoint(u, u_bar, p, p_bar):
    kernel_adjoint_taped(u, u_bar, p, p_bar, np.empty(0))
