"""A full overwrite by a constant: nothing depends on what was there, and nothing of it is run."""
import numpy as np


def kernel(y, x):
    for i in range(y.size):
        y[i] = x[i] * x[i]
    for i in range(y.size):
        y[i] = 0.5
    y[0] = x[0] * x[1]


ARGUMENTS = (np.zeros(2), np.array([0.7, -1.3]))
WRT, OF = ("x", "y"), ("y",)
