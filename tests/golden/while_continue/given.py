"""A while loop with a continue."""
import numpy as np


def kernel(x):
    k, total = 0, 0.0
    while k < x.size:
        k += 1
        if x[k - 1] < 0.0:
            continue
        total += x[k - 1] ** 3
    return total


ARGUMENTS = (np.array([1.5, -2.5, 0.4, 1.1]),)
WRT, OF = ("x",), ("return",)
