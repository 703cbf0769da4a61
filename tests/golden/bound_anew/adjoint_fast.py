"""Adjoint of kernel: d(return) / d(u, rate).

Engine: Numba. Level: fast. Arguments:
    u: float64[:], in
    rate: float64, in
    n: int64, in

It records:
    u_1_stack: u_1 before `u = u - rate * u ** 2`,
        8 * len(range(n)) * u_1.shape[0] bytes
"""

import numpy as np

from s2sad.runtime import added, allocate, allocate_zeros, sized  # isort: skip


def kernel_adjoint_taped(u, u_bar, rate, n, result_bar, u_1_stack, arena):
    """Adjoint of kernel: d(return) / d(u, rate), in given memory."""
    # forward sweep: only what the reverse sweep reads
    before, top = allocate(arena, 0, u.shape)
    u_1, top = allocate(arena, top, u.shape)
    for i in range(u.shape[0]):
        before[i] = u[i]
        u_1[i] = u[i]
    u_1_stack = sized(u_1_stack, (len(range(n)), u.shape[0]))
    for _ in range(n):
        for i in range(u.shape[0]):
            u_1_here = u_1[i]
            u_1_2_here_ = u_1_here - rate * u_1_here ** 2
            before[i] = u_1[i]
            u_1_stack[_, i] = u_1[i]
            u_1[i] = u_1_2_here_
    returned, top = allocate(arena, top, u.shape)
    assert returned.shape == result_bar.shape, "result_bar does not have the shape of the result"
    # reverse sweep
    rate_bar = 0.0
    before_bar, top = allocate_zeros(arena, top, u.shape)
    u_1_bar, top = allocate_zeros(arena, top, u.shape)
    for i in range(u.shape[0]):
        returned_bar_here = 0.0
        # return u * before
        returned_bar_here += result_bar[i]
        seed = returned_bar_here
        before_bar[i] += u_1[i] * seed
        u_1_bar[i] += before[i] * seed
    for _ in range(n - 1, -1, -1):
        for i in range(u.shape[0]):
            u_1_2_bar_here = 0.0
            # u = u - rate * u ** 2
            u_1[i] = u_1_stack[_, i]
            seed = u_1_bar[i]
            u_1_bar[i] = 0.0
            u_1_2_bar_here += seed
            seed = before_bar[i]
            before_bar[i] = 0.0
            u_1_bar[i] += seed
            u_1_here = u_1[i]
            seed = u_1_2_bar_here
            rate_bar = added(rate_bar, -(u_1_here ** 2 * seed))
            u_1_bar[i] += seed - 2.0 * u_1_here * (rate * seed)
    for i in range(u.shape[0]):
        seed = u_1_bar[i]
        u_1_bar[i] = 0.0
        u_bar[i] += seed
        seed = before_bar[i]
        before_bar[i] = 0.0
        u_bar[i] += seed
    return rate_bar, u_1_stack, top


def kernel_adjoint(u, u_bar, rate, n, result_bar):
    returned = kernel_adjoint_taped(u, u_bar, rate, n, result_bar, np.empty((0, 0)), np.empty(0))
    return (returned[0],)
