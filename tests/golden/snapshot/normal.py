"""Normal form."""

import numpy as np


def kernel(u, dt, steps):
    du = np.empty_like(u)
    for _ in range(steps):
        for i in range(u.size):
            u_here = u[i - 1]
            u_here_2 = u[i]
            du[i] = u_here * u_here_2
        u[...] += dt * du
