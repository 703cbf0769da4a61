"""A result that stays where it was stored: the reverse sweep reads it there."""
import math

import numpy as np


def kernel(a):
    for j in range(a.shape[0]):
        a[j, j] = math.sqrt(a[j, j])
        for i in range(j + 1, a.shape[0]):
            a[i, j] /= a[j, j]
            a[i, i] -= a[i, j] * a[i, j]


ARGUMENTS = (np.array([[4.0, 1.0, 0.5], [1.0, 5.0, 0.2], [0.5, 0.2, 6.0]]),)
WRT, OF = ("a",), ("a",)
