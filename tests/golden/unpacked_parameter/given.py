"""An array parameter unpacked into names."""
import numpy as np


def kernel(u, p):
    a, b, c = p
    for i in range(u.size):
        u[i] = a * u[i] * u[i] + b / c


ARGUMENTS = (np.array([0.7, -1.3]), np.array([1.2, 0.8, 1.5]))
WRT, OF = ("u", "p"), ("u",)
