"""A loop left in two ways: a break, and a return from inside it."""
import numpy as np


def kernel(x, limit):
    total = 1.0
    for i in range(x.size):
        if x[i] < 0.0:
            return total * x[i]
        total = total * x[i]
        if total > limit:
            break
    return total * total


ARGUMENTS = (np.array([1.5, 2.5, 0.4, -1.1]), 3.0)
WRT, OF = ("x",), ("return",)
