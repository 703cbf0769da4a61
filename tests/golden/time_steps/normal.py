"""Normal form."""

import numpy as np


def kernel(u, c, n):
    v = np.empty_like(u)
    energy = 0.0
    energy_1 = energy
    for k in range(n):
        for i in range(u.size):
            u_here = u[i]
            v[i] = np.sin(u_here) + k
        u[...] += c * v
        u_here_2 = u[0]
        u_here_3 = u[1]
        energy_1 += u_here_2 * u_here_3
    return energy_1
