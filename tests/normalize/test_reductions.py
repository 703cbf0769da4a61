"""Reductions of a number: NumPy takes it for an array without axes."""
from __future__ import annotations

import numpy as np

from s2sad import differentiate, gradient


def of_one(a):
    return np.sum(a * a) + np.mean(a) + np.std(a) + np.linalg.norm(a)


def test_a_number_of_its_own():
    assert gradient(of_one)(1.5) == 5.0
    assert gradient(of_one)(-1.5) == -3.0
    assert np.isnan(differentiate(lambda a: np.std(a) + a).primal(np.inf))
