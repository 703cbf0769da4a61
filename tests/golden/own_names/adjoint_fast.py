"""Adjoint of kernel: d(return) / d(u, seed).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in
    seed: float64, in

It records:
    u_bar_stack: u_bar where an iteration of `for np in range(1, u.size):` begins,
        8 * len(range(1, u.size)) bytes
"""

import math

import numpy as np_

from s2sad.runtime import added, sized  # isort: skip


def kernel_adjoint_taped(u, u_bar_, seed, result_bar, u_bar_stack):
    """Adjoint of kernel: d(return) / d(u, seed), in given memory."""
    # forward sweep: only what the reverse sweep reads
    u_bar = math.sin(u[0])
    u_bar_stack = sized(u_bar_stack, (len(range(1, u.size)),))
    for np in range(1, u.size):
        u_bar_stack[np - 1] = u_bar
        u_bar = u_bar * u[np] * seed
    # reverse sweep
    seed_bar = 0.0
    # return u_bar
    u_bar_bar = result_bar
    for np in range(u.size - 1, 0, -1):
        u_bar = u_bar_stack[np - 1]
        # u_bar = u_bar * u[np] * seed
        u_bar_bar_1 = u_bar_bar
        seed_2 = seed * u_bar_bar_1
        u_bar_bar = u[np] * seed_2
        u_bar_[np] += u_bar * seed_2
        seed_bar = added(seed_bar, u_bar * u[np] * u_bar_bar_1)
    # u_bar = math.sin(u[0])
    u_bar_[0] += np_.cos(u[0]) * u_bar_bar
    return seed_bar, u_bar_stack


def kernel_adjoint(u, u_bar_, seed, result_bar):
    returned = kernel_adjoint_taped(u, u_bar_, seed, result_bar, np_.empty(0))
    return (returned[0],)
