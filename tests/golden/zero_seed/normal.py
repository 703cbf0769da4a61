"""Normal form."""

import math


def kernel(y, x):
    for i in range(x.size):
        root = math.sqrt(x[i])
        taken = x[i] > 0.0
        if taken:
            y[i] = root
        else:
            y[i] = 0.0
