"""Adjoint of kernel: d(u) / d(u, k).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in-out
    k: float64, in
    steps: int64, in

It records:
    u_stack: u before `step(u, k)`, 8 * len(range(steps)) * u.size bytes
"""

import numpy as np


def step(u, k):
    for i in range(u.size):
        u[i] += k * u[i] * u[i]


def step_adjoint(u, u_bar, k):
    """Adjoint of step: d(u) / d(u, k)."""
    # reverse sweep
    k_bar = 0.0
    for i in range(u.size - 1, -1, -1):
        # u[i] += k * u[i] * u[i]
        u_here = u[i]
        seed = u_bar[i]
        seed_2 = u_here * seed
        k_bar += u_here * seed_2
        u_bar[i] += k * seed_2 + k * u_here * seed
    return (k_bar,)


def kernel_adjoint(u, u_bar, k, steps):
    # forward sweep: only what the reverse sweep reads
    u_stack = np.empty((len(range(steps)),) + u.shape)
    for _ in range(steps):
        u_stack[_] = u
        step(u, k)
    # reverse sweep
    k_bar = 0.0
    for _ in range(steps - 1, -1, -1):
        # step(u, k)
        u[...] = u_stack[_]
        (gain,) = step_adjoint(u, u_bar, k)
        k_bar += gain
    return (k_bar,)
