"""Products of one matrix with the rows of a loop are products of blocks of rows; what they give is the same."""
from __future__ import annotations

import pytest

from s2sad import differentiate
from tests.corpus.loops.row_products import CASES


@pytest.mark.parametrize("case, products", [(0, 5), (3, 4), (6, 1), (7, 0), (8, 2), (9, 2)])
def test_blocks(case, products):
    """How many products of blocks a reverse sweep has."""
    kernel, arguments, wrt, of = CASES[case]
    text = differentiate(kernel, wrt=wrt, of=of, engine="numba").adjoint_source(*arguments, level="fast")
    assert sum("_rows = " in line or "_gain = " in line for line in text.splitlines()) == products, text
