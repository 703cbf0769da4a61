"""Numbers carried from one iteration to the next while the array is overwritten."""
import numpy as np


def kernel(u, c):
    left = u[u.size - 1]
    for i in range(u.size):
        here = u[i]
        u[i] = here - c * here * (here - left)
        left = here
    total = 0.0
    for i in range(u.size):
        total += u[i] * u[i]
    return total


ARGUMENTS = (np.array([0.7, -1.3, 0.4, 1.1]), 0.3)
WRT, OF = ("u", "c"), ("u", "return")
