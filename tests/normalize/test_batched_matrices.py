"""Functions of matrices that are given stacks of these."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.library.batched_matrices import arguments
from tests.harness.derivatives import check_derivatives


def test_right_sides_of_one_matrix_are_solved_at_once():
    def kernel(a, b):
        return np.sum(np.linalg.solve(a, b) ** 2)
    text = s2sad.differentiate(kernel, engine="numpy").adjoint_source(np.eye(3), np.ones((4, 3, 2)))
    assert "for " not in text
    check_derivatives(kernel, (arguments()[0][0], np.ones((0, 3, 2))), ("a", "b"), ("return",))


def test_stacks_of_different_sizes():
    def kernel(a, b):
        return np.sum(np.linalg.solve(a, b))
    for engine in ("numpy", "numba"):
        gradient = s2sad.gradient(s2sad.differentiate(kernel, engine=engine))
        with pytest.raises(s2sad.S2sadError) as raised:
            gradient(np.ones((1, 3, 3)) + np.eye(3), np.ones((2, 3, 3)))
        found = raised.value.diagnostics[0]
        assert (found.code, found.message, found.note) == (
            "S501", "stacks of different sizes", "a.shape[0] is 1, b.shape[0] is 2")
        assert found.help == "repeat the matrices of the shorter one, np.repeat(a, n, axis=0)"
