"""Negative indices and indices that wrap around."""
import numpy as np


def kernel(y, x):
    n = x.size
    for i in range(n):
        y[i] = x[i - 1] * x[(i + 2) % n]
    y[-1] = y[-1] * x[-2]


ARGUMENTS = (np.zeros(4), np.array([0.7, -1.3, 0.4, 1.1]))
WRT, OF = ("x",), ("y",)
