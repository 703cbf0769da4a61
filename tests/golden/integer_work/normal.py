"""Normal form."""

import numpy as np


def kernel(y, x):
    order = np.zeros(x.size, np.int64)
    flags = np.zeros(x.size, np.bool_)
    for i in range(x.size):
        order[i] = x.size - 1 - i
        flags[i] = x[i] > 0.0
    for i in range(x.size):
        taken = flags[order[i]]
        if taken:
            place = order[i]
            y[i] = x[place] * x[i]
