"""The user's own u_bar, seed and np: they stay, and s2sad's names give way."""
import math

import numpy


def kernel(u, seed):
    u_bar = math.sin(u[0])
    for np in range(1, u.size):
        u_bar = u_bar * u[np] * seed
    return u_bar


ARGUMENTS = (numpy.array([0.7, -1.3, 0.4]), 1.5)
WRT, OF = ("u", "seed"), ("return",)
