"""Fourier transforms: the adjoints of the runtime against matrices, and derivatives of kernels."""
from __future__ import annotations

import numpy as np

from tests.runtime import transform_kernels as kernels
from tests.corpus import Case
from tests.harness.seeds import generator

RNG = generator(11)
X, Y = RNG.normal(size=(2, 5))
Z = RNG.normal(size=4) + 1j * RNG.normal(size=4)
CASES = [
    (kernels.heat, (X[:4], 0.1, 0.2, 2), ("u", "nu", "dt"), ("u", "return")),
    (kernels.burgers, (X, 0.05, 3.0), ("u", "dt", "length"), ("u", "return")),
    (kernels.split_step, (Z, Y[:4], Y[1:], 0.3), ("psi", "v", "w", "dt"), ("psi", "return")),
    (kernels.poisson, (np.outer(X[:3], Y), np.zeros((3, 5))), ("f",), ("phi",)),
    (kernels.lengths, (X, Z), ("x", "z"), ("return",)),
    (kernels.several_axes, (np.outer(X[:3], Z.real), np.outer(Y[:3], Z)), ("x", "z"), ("return",)),
    (kernels.shifts, (np.outer(X[:3], Z.real), np.outer(Y[:3], Z)), ("x", "z"), ("return",)),
]


def cases():
    # derivatives
    for case in CASES:
        yield Case(*case)
