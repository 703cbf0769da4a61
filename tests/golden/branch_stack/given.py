"""A branch on a value that is overwritten: which way it went is recorded."""
import numpy as np


def kernel(x):
    for i in range(1, x.size):
        if x[i] > x[i - 1]:
            x[i] = x[i] * x[i - 1]
        else:
            x[i] = 3.0 * x[i]


ARGUMENTS = (np.array([0.7, 1.3, 0.4, 1.1]),)
WRT, OF = ("x",), ("x",)
