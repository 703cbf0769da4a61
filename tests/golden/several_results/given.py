"""A helper with several results, of which one is an integer."""
import math

import numpy as np


def polar(a, b):
    return math.hypot(a, b), math.atan2(b, a), 2


def kernel(x):
    radius, angle, count = polar(x[0], x[1])
    return radius ** count * angle


ARGUMENTS = (np.array([0.7, 1.3]),)
WRT, OF = ("x",), ("return",)
