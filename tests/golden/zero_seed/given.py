"""A partial that may be infinite: a zero seed adds exactly zero to it."""
import math

import numpy as np


def kernel(y, x):
    for i in range(x.size):
        root = math.sqrt(x[i])
        y[i] = root if x[i] > 0.0 else 0.0


ARGUMENTS = (np.zeros(3), np.array([0.7, 1.3, 0.4]))
WRT, OF = ("x",), ("y",)
