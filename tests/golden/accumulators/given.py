"""Sums: into a name, into a cell, and a product that is no sum."""
import numpy as np


def kernel(y, x):
    total, product = 0.0, 1.0
    for i in range(x.size):
        total += x[i] * x[i]
        y[0] -= 2.0 * x[i]
        product *= x[i]
    y[1] = total * product


ARGUMENTS = (np.array([0.2, 0.3]), np.array([0.7, -1.3, 0.4]))
WRT, OF = ("y", "x"), ("y",)
