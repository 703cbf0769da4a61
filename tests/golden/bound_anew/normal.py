"""Normal form."""

import numpy as np


def kernel(u, rate, n):
    before = np.empty_like(u)
    before[...] = u
    u_1 = np.empty_like(u)
    u_1[...] = u
    u_1_2 = np.empty_like(u_1)
    for _ in range(n):
        u_1_2[...] = u_1 - rate * u_1 ** 2
        before[...] = u_1
        u_1[...] = u_1_2
    returned = np.empty_like(u_1)
    returned[...] = u_1 * before
    return returned
