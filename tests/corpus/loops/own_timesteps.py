"""Functions of the user's that are called as s2sad's mark of a loop is."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def timesteps(indices, width):
    for i in indices:
        yield i * width


def of_the_module(x):
    y = x[0]
    for t in timesteps(range(4), 3):
        y += x[1] * np.sin(x[2] * t)
    return y ** 2


def of_the_function(x):
    def timesteps(indices, width):
        return [i * width for i in indices]
    y = x[0]
    for t in timesteps(range(4), 3):
        y += x[1] * np.sin(x[2] * t)
    return y ** 2


def cases():
    for kernel in (of_the_module, of_the_function):
        yield Case(kernel, (np.array([0.8, 0.5, 0.3]),), ("x",), ("return",))
