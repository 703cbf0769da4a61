"""What generated kernels with whole arrays have found, made small."""
from __future__ import annotations

import numpy as np
import pytest

from tests.derivatives import check_derivatives

ENGINES = ("numpy", "numba")


def joined_masks(x, y, m):
    low = x < 0.3
    y[low & (x < 0.2)] *= 0.5
    y[low | (y > 0.9)] -= 0.3 * x[0]
    both = (x > 0.1) ^ ~low
    x[both] *= y[both] * y[both]
    m[(x[:3] < 0.3) & (y[:3] > -2.0)] *= x[:4]


def numbers_spread_and_summed(x, y, m):
    a = np.sum(x[1] * np.ones(3), axis=0)
    y[1] = a ** 3 + (x[2] * np.ones((3, 2))).mean()
    m[:, 1] += np.sum(y[0] * np.ones((3, 5)), axis=1)
    m[0] *= np.mean(x[3] * y[2] * np.ones((2, 4)), axis=0)


KERNELS = (joined_masks, numbers_spread_and_summed)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.__name__)
def test_kernel(kernel, engine):
    random = np.random.default_rng(5)
    given = random.uniform(-0.9, 0.9, 5), random.uniform(-0.9, 0.9, 5), random.uniform(-0.9, 0.9, (3, 4))
    left = tuple(a.copy() for a in given)
    kernel(*left)
    of = tuple(n for n, p, q in zip("xym", given, left) if not np.array_equal(p, q))
    check_derivatives(kernel, given, ("x", "y", "m"), of, engine)
