"""Functions that return arrays and are called more than once write into arrays that they are given."""
from __future__ import annotations

import numpy as np

import s2sad
from tests.corpus.calls.destination_passing import X, rows, runge_kutta


def test_the_text():
    text = s2sad.differentiate(runge_kutta, engine="numba").adjoint_source(X, 0.4)
    assert text.count("rhs_into(") == 5 and text.count("rhs_into_adjoint(") == 5 and "np.sin" in text


def test_called_once_it_is_written_out():
    def once(x):
        return np.sum(rows(np.stack([x, x])))
    assert "rows_into" not in s2sad.differentiate(once, engine="numpy").adjoint_source(X)
