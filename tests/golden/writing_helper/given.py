"""A helper that writes its argument, and a snapshot of what it overwrites."""
import numpy as np


def step(u, k):
    for i in range(u.size):
        u[i] += k * u[i] * u[i]


def kernel(u, k, steps):
    for _ in range(steps):
        step(u, k)


ARGUMENTS = (np.array([0.7, -1.3, 0.4]), 0.1, 2)
WRT, OF = ("u", "k"), ("u",)
