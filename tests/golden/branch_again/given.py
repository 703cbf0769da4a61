"""A branch on values that stay: it is taken again in the reverse sweep, nothing is recorded."""
import numpy as np


def kernel(y, x):
    for i in range(x.size):
        if x[i] > 0.5:
            y[i] = x[i] * x[i]
        else:
            y[i] = 3.0 * x[i]


ARGUMENTS = (np.zeros(4), np.array([0.7, 1.3, 0.4, 0.1]))
WRT, OF = ("x",), ("y",)
