"""A kernel and a function that it calls return arrays; a part of an argument is one of the results."""
import numpy as np


def differences(v):
    out = np.zeros_like(v)
    for i in range(1, v.size):
        out[i] = v[i] - v[i - 1]
    return out


def kernel(u, a):
    slope = a * differences(u)
    return slope, u[1:], slope


ARGUMENTS = (np.array([0.5, 1.5, 1.0]), 0.7)
WRT, OF = ("u", "a"), ("return",)
