"""Functions of whole arrays that are written out."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad


def no_slope_where_all_is_equal(x):
    return np.std(0.0 * x) + np.linalg.norm(0.0 * x)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_where_formulas_of_calculus_divide_by_zero(engine):
    np.testing.assert_array_equal(s2sad.gradient(s2sad.differentiate(no_slope_where_all_is_equal, engine=engine))(
        np.array([1.0, 2.0, 3.0])), np.zeros(3))
