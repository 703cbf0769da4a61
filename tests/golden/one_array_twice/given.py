"""One array for two parameters of a helper that writes one of them."""
import numpy as np


def add(out, a, b):
    for i in range(out.size):
        out[i] = a[i] * b[i]


def kernel(u, v):
    add(v, u, u)
    add(u, u, v)


ARGUMENTS = (np.array([0.7, -1.3]), np.array([0.4, 1.1]))
WRT, OF = ("u", "v"), ("u", "v")
