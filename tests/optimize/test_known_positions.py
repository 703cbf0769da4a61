"""known_positions: where bounds of slices are what they are, and where NumPy's rules for them have to be asked."""
from __future__ import annotations

import numpy as np
import pytest

from tests.corpus.loops.known_positions import (
    beyond_the_end, bounds_that_an_iteration_moves, downwards, flipped, from_before_the_beginning, moved,
    of_another_size, to_the_end, within,
)
from tests.optimize.test_levels import texts

X = np.ones(5)


@pytest.mark.parametrize(("kernel", "asked"), [
    (within, False), (to_the_end, False), (flipped, False), (beyond_the_end, True), (from_before_the_beginning, True),
    (downwards, True), (of_another_size, True), (bounds_that_an_iteration_moves, True), (moved, True)])
def test_what_is_asked(kernel, asked):
    arguments = (X, X, 1) if kernel is moved else (X, X)
    plain, fast = (t.text.partition("def ")[2] for t in texts(kernel, arguments, ("x", "y"), ("y",)))
    assert "position" in plain
    assert ("position" in fast) == asked
