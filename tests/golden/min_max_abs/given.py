"""min, max and abs: each has one side at its kink."""
import numpy as np


def kernel(y, x, top):
    for i in range(x.size):
        y[i] = min(max(x[i], 0.1), top) * abs(x[i])


ARGUMENTS = (np.zeros(3), np.array([0.7, -1.3, 0.4]), 0.6)
WRT, OF = ("x", "top"), ("y",)
