"""A number that is overwritten in a loop of known length: its values lie on a stack of that length."""
import math

import numpy as np


def kernel(x):
    state = 0.5
    for i in range(x.size):
        state = math.sin(state) * x[i]
    return state


ARGUMENTS = (np.array([0.7, -1.3, 0.4, 1.1]),)
WRT, OF = ("x",), ("return",)
