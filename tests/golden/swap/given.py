"""Two cells change places, and two names."""
import numpy as np


def kernel(x):
    a, b = x[0], 2.0 * x[1]
    a, b = b, a
    x[1], x[2] = x[2], x[1]
    x[0] = a * b


ARGUMENTS = (np.array([0.7, -1.3, 0.4]),)
WRT, OF = ("x",), ("x",)
