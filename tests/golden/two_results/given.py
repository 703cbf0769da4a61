"""Two results, each with a seed."""
import numpy as np


def kernel(x, a):
    total, product = 0.0, a
    for i in range(x.size):
        total += a * x[i]
        product *= x[i]
    return total, product


ARGUMENTS = (np.array([0.7, -1.3, 0.4]), 1.5)
WRT, OF = ("x", "a"), ("return",)
