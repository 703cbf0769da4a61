"""A guard is kept, what is printed is not, and what no output depends on is left out."""
import math

import numpy as np


def kernel(y, x):
    assert x.size > 0, "no data"
    spread = 0.0
    for i in range(x.size):
        spread += math.exp(x[i])
        y[i] = 2.0 * x[i]
    print("spread", spread)


ARGUMENTS = (np.zeros(2), np.array([0.7, -1.3]))
WRT, OF = ("x",), ("y",)
