"""Random numbers are not drawn in a kernel: an adjoint that drew its own would be that of another function."""
from __future__ import annotations

import random

import numpy as np
from numpy.random import randn

from tests.corpus import Case


def seeded(x):
    np.random.seed(0)
    return x[0]


def of_a_generator(x):
    rng = np.random.default_rng(0)
    return np.sum(rng.standard_normal(3) * x)


def imported(x):
    return np.sum(randn(3) * x)


def of_python(x):
    return x[0] * random.random()


def cases():
    x = np.array([0.4, 1.2, 0.7])
    for kernel, said in ((seeded, "np.random.seed"), (of_a_generator, "np.random.default_rng"), (imported, "randn"),
                         (of_python, "random.random")):
        yield Case(kernel, (x,), ("x",), refused=(
            f"S201 at `{said}`: '{said}' draws random numbers, or begins a sequence of them: draw them before, and "
            "give them to the kernel as an argument: both sweeps read the same ones"))
