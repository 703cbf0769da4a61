"""Names that a loop binds to new arrays, one of them to what another one was."""
import numpy as np


def kernel(u, rate, n):
    before = u
    for _ in range(n):
        before = u
        u = u - rate * u ** 2
    return u * before


ARGUMENTS = (np.array([0.5, 1.5, 1.0]), 0.1, 2)
WRT, OF = ("u", "rate"), ("return",)
