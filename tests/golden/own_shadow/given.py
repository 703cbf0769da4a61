"""An array in wrt but not in of that is written: a shadow of its own, added to the caller's."""
import numpy as np


def kernel(y, x):
    for i in range(x.size):
        x[i] = x[i] * x[i]
        y[i] = 3.0 * x[i]


ARGUMENTS = (np.zeros(2), np.array([0.7, -1.3]))
WRT, OF = ("x",), ("y",)
