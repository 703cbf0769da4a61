"""An array that every step overwrites as a whole: one snapshot for a step, not one push for a cell."""
import numpy as np


def kernel(u, dt, steps):
    du = np.empty_like(u)
    for _ in range(steps):
        for i in range(u.size):
            du[i] = u[i - 1] * u[i]
        u += dt * du


ARGUMENTS = (np.array([0.7, -1.3, 0.4]), 0.1, 2)
WRT, OF = ("u",), ("u",)
