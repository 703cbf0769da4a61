"""Adjoint of kernel: d(u) / d(u, k).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in-out
    k: float64, in
    steps: int64, in

It records:
    u_stack: u before `step(u, k)`, 8 * len(range(steps)) * u.size bytes
"""

import numpy as np

from s2sad.runtime import added, sized  # isort: skip


def step(u, k):
    for i in range(u.size):
        u[i] += k * u[i] * u[i]


def step_adjoint(u, u_bar, k):
    """Adjoint of step: d(u) / d(u, k)."""
    # reverse sweep
    k_bar = 0.0
    for i in range(u.size):
        # u[i] += k * u[i] * u[i]
        u_here = u[i]
        seed = u_bar[i]
        seed_2 = u_here * seed
        k_bar = added(k_bar, u_here * seed_2)
        u_bar[i] += k * seed_2 + k * u_here * seed
    return (k_bar,)


def kernel_adjoint_taped(u, u_bar, k, steps, u_stack):
    """Adjoint of kernel: d(u) / d(u, k), in given memory."""
    # forward sweep: only what the reverse sweep reads
    u_stack = sized(u_stack, (len(range(steps)),) + u.shape)
    for _ in range(steps):
        for i in range(u_stack.shape[1]):
            u_stack[_, i] = u[i]
        step(u, k)
    # reverse sweep
    k_bar = 0.0
    for _ in range(steps - 1, -1, -1):
        for i in range(u.shape[0]):
            # step(u, k)
            u[i] = u_stack[_, i]
        # step(u, k)
        (gain,) = step_adjoint(u, u_bar, k)
        k_bar += gain
    return k_bar, u_stack


def kernel_adjoint(u, u_bar, k, steps):
    returned = kernel_adjoint_taped(u, u_bar, k, steps, np.empty((0, 0)))
    return (returned[0],)
