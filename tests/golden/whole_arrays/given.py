"""Statements on whole arrays and a sum; for Numba they become loops."""
import numpy as np


def kernel(y, x, a):
    y[:] = a * x + y
    y *= np.sin(x)
    return np.sum(y * y)


ARGUMENTS = (np.array([0.2, 0.3, -0.1]), np.array([0.7, -1.3, 0.4]), 1.5)
WRT, OF = ("y", "x", "a"), ("y", "return")
