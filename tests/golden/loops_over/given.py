"""Loops over an array, over pairs, numbered, and backwards."""
import numpy as np


def kernel(x, y):
    total = 0.0
    for value, other in zip(x, y):
        total += value * other
    for k, value in enumerate(x):
        y[k] = total * value
    for i in reversed(range(1, x.size)):
        total *= x[i]
    return total


ARGUMENTS = (np.array([0.7, -1.3, 0.4]), np.array([1.2, 0.8, 1.5]))
WRT, OF = ("x", "y"), ("y", "return")
