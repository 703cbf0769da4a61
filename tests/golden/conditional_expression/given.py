"""A conditional expression, one that guards a read."""
import numpy as np


def kernel(y, x):
    for i in range(x.size):
        right = x[i + 1] if i < x.size - 1 else 0.5
        y[i] = right * x[i]


ARGUMENTS = (np.zeros(3), np.array([0.7, -1.3, 0.4]))
WRT, OF = ("x",), ("y",)
