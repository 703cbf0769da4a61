"""Two loops, the inner one's length changing: an outer value and an inner one are recorded."""
import math

import numpy as np


def kernel(x):
    total = 1.0
    for i in range(x.size):
        part = x[i]
        for _ in range(i + 1):
            part = part * math.cos(part)
        total = total * part
    return total


ARGUMENTS = (np.array([0.7, -1.3, 0.4]),)
WRT, OF = ("x",), ("return",)
