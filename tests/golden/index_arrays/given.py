"""Gather and scatter through index arrays."""
import numpy as np


def kernel(y, x, source, target):
    for e in range(source.size):
        flow = x[source[e]] * x[target[e]]
        y[source[e]] -= flow
        y[target[e]] += flow


ARGUMENTS = (np.zeros(3), np.array([0.7, -1.3, 0.4]), np.array([0, 1, 2, 0]), np.array([1, 2, 0, 0]))
WRT, OF = ("x",), ("y",)
