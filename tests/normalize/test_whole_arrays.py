"""Kernels with slices, views, broadcasting, reductions and linear algebra, under both engines."""
from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import s2sad

ENGINES = ("numpy", "numba")


def scaled_tail(x):
    n = x.size
    x[n - 5:] *= 2.0


@pytest.mark.parametrize("engine", ENGINES)
def test_a_bound_that_would_count_from_the_end_is_guarded(engine):
    vjp = partial(s2sad.vjp, s2sad.differentiate(wrt="x", of=("x",), engine=engine)(scaled_tail))
    assert vjp((np.ones(6),), {"x": np.ones(6)})["x"].tolist() == [1.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    with pytest.raises(s2sad.S2sadError):
        vjp((np.ones(4),), {"x": np.ones(4)})
