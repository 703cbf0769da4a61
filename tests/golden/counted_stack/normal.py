"""Normal form."""

import math


def kernel(x):
    state = 0.5
    state_1 = state
    for i in range(x.size):
        state_2 = math.sin(state_1) * x[i]
        state_1 = state_2
    return state_1
