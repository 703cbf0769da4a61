"""A helper that calls a helper, and returns a number of what it was given as an array."""
import numpy as np


def square(a):
    return a * a


def energy(row):
    total = 0.0
    for i in range(row.size):
        total += square(row[i])
    return total


def kernel(y, x):
    for i in range(x.shape[0]):
        y[i] = y[i] * energy(x[i])


ARGUMENTS = (np.array([0.2, 0.3]), np.array([[0.7, -1.3], [0.4, 1.1]]))
WRT, OF = ("y", "x"), ("y",)
