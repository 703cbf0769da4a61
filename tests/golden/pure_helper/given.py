"""A helper of numbers with a branch of its own; each function has its derivative once."""
import numpy as np


def bent(a, b):
    if a * b <= 0.0:
        return 0.0
    return a * a / b


def kernel(y, x):
    for i in range(1, x.size):
        y[i] = bent(x[i], x[i - 1]) + 3.0 * bent(x[i - 1], 2.0)


ARGUMENTS = (np.zeros(4), np.array([0.7, 1.3, -0.4, 1.1]))
WRT, OF = ("x",), ("y",)
