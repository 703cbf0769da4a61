"""Adjoint of kernel: d(return) / d(u, rate).

Engine: NumPy. Level: plain. Arguments:
    u: float64[:], in
    rate: float64, in
    n: int64, in

It records:
    u_1_stack: u_1 before `u = u - rate * u ** 2`, 8 * len(range(n)) * u_1.size
        bytes
"""

import numpy as np


def kernel_adjoint(u, u_bar, rate, n, result_bar):
    # forward sweep: only what the reverse sweep reads
    before = np.empty_like(u)
    before[...] = u
    u_1 = np.empty_like(u)
    u_1[...] = u
    u_1_2 = np.empty_like(u_1)
    u_1_stack = np.empty((len(range(n)),) + u_1.shape)
    for _ in range(n):
        u_1_2[...] = u_1 - rate * u_1 ** 2
        before[...] = u_1
        u_1_stack[_] = u_1
        u_1[...] = u_1_2
    returned = np.empty_like(u_1)
    assert returned.shape == result_bar.shape, "result_bar does not have the shape of the result"
    # reverse sweep
    rate_bar = 0.0
    before_bar = np.zeros_like(before)
    u_1_bar = np.zeros_like(u_1)
    u_1_2_bar = np.zeros_like(u_1_2)
    returned_bar = np.zeros_like(returned)
    # return u * before
    returned_bar[...] += result_bar
    u_1_bar[...] += before * returned_bar
    before_bar[...] += u_1 * returned_bar
    for _ in range(n - 1, -1, -1):
        # u = u - rate * u ** 2
        u_1[...] = u_1_stack[_]
        seed_2 = np.copy(u_1_bar)
        u_1_2_bar[...] += seed_2
        seed_3 = np.copy(before_bar)
        before_bar[...] = 0.0
        u_1_bar[...] = seed_3
        u_1_bar[...] += u_1_2_bar - 2.0 * u_1 * (rate * u_1_2_bar)
        rate_bar -= np.sum(u_1 ** 2 * u_1_2_bar)
        u_1_2_bar[...] = 0.0
    seed_5 = np.copy(u_1_bar)
    u_bar[...] += seed_5
    seed_6 = np.copy(before_bar)
    u_bar[...] += seed_6
    return (rate_bar,)
