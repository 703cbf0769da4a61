"""A loop over time steps that keeps snapshots."""
import numpy as np
from s2sad import timesteps


def kernel(u, c, n: int):
    v = np.empty_like(u)
    energy = 0.0
    for k in timesteps(range(n), snapshots=3):
        for i in range(u.size):
            v[i] = np.sin(u[i]) + k
        u += c * v
        energy += u[0] * u[1]
    return energy


ARGUMENTS = (np.array([0.7, -1.3, 0.4, 1.1]), 0.3, 7)
WRT, OF = ("u", "c"), ("u", "return")
