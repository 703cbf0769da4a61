"""Normal form."""

import math

import numpy as np


def kernel(y, x):
    for i in range(x.size):
        half = np.float32(0.5) * x[i]
        exp_value = math.exp(half)
        y[i] = half * exp_value
