"""An array of integers and an array of flags that the kernel fills itself."""
import numpy as np


def kernel(y, x):
    order = np.zeros(x.size, np.int64)
    flags = np.zeros(x.size, np.bool_)
    for i in range(x.size):
        order[i] = x.size - 1 - i
        flags[i] = x[i] > 0.0
    for i in range(x.size):
        if flags[order[i]]:
            y[i] = x[order[i]] * x[i]


ARGUMENTS = (np.zeros(3), np.array([0.7, -1.3, 0.4]))
WRT, OF = ("y", "x"), ("y",)
