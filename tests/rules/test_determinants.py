"""Determinants of singular matrices."""
from __future__ import annotations

import numpy as np

import s2sad


def test_a_determinant_of_zero():
    def kernel(a):
        return np.linalg.det(a)
    a = np.array([[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 0.0, 3.0]])
    np.testing.assert_allclose(s2sad.gradient(kernel)(a), [[12, -6, 0], [-6, 3, 0], [0, 0, 0]], atol=1e-12)
