"""A constant and an array of the module: the array becomes a parameter."""
import numpy as np

G = 9.81
TABLE = np.array([0.5, -1.5, 2.5])


def kernel(x):
    total = 0.0
    for i in range(x.size):
        total += TABLE[i] * x[i] ** 2
    return G * total


ARGUMENTS = (np.array([0.7, -1.3, 0.4]),)
WRT, OF = ("x",), ("return",)
