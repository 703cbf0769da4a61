"""Colours: columns of one share no row, whatever the pattern."""
from __future__ import annotations

import numpy as np
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays

from s2sad.jacobians.coloring import colored
from s2sad.jacobians.linear_maps import dense
from s2sad.jacobians.sparsity import pattern_of


class Matrix:
    """A matrix as a linear map, of which a nan shows whatever the entry is that it meets."""
    dtype = np.dtype(float)

    def __init__(self, pattern):
        self.pattern, self.given, self.taken = pattern, (len(pattern),), (pattern.shape[1],)

    def product(self, direction):
        return np.array([sum((0.5 * v for v, there in zip(direction, row) if there), 0.0) for row in self.pattern])

    def transposed_product(self, weights):
        return Matrix(self.pattern.T).product(weights)


PATTERNS = st.tuples(st.integers(0, 7), st.integers(0, 9)).flatmap(lambda shape: arrays(bool, shape))


@given(PATTERNS)
@settings(max_examples=60, deadline=None)
def test_the_pattern_is_found_and_its_colours_hold(pattern):
    rows, columns = pattern_of(Matrix(pattern))
    wanted = np.nonzero(pattern)
    np.testing.assert_array_equal(rows, wanted[0])
    np.testing.assert_array_equal(columns, wanted[1])
    colors = colored(columns, rows, pattern.shape[1], pattern.shape[0])
    for row in pattern:
        assert len({*colors[row]}) == row.sum()


@given(PATTERNS)
@settings(max_examples=30, deadline=None)
def test_columns_and_rows_give_one_matrix(pattern):
    for mode in ("forward", "reverse"):
        np.testing.assert_array_equal(dense(Matrix(pattern), mode), 0.5 * pattern)
