"""A work array made in every iteration: made once."""
import numpy as np


def kernel(y, x):
    for i in range(x.size):
        work = np.zeros(2)
        work[0] = x[i] * x[i]
        work[1] = work[0] * x[i]
        y[i] = work[0] + work[1]


ARGUMENTS = (np.zeros(3), np.array([0.7, -1.3, 0.4]))
WRT, OF = ("x",), ("y",)
