"""Arrays that one statement only hands to the next are numbers in the loops for Numba, and are not recorded."""
from __future__ import annotations

from s2sad import differentiate, explain
from tests.corpus.loops.array_contraction import RNG, U, V, relaxed


def test_what_is_handed_on_is_not_recorded():
    found = explain(differentiate(relaxed, wrt=("f", "u", "v", "rate"), of=("f",), engine="numba"),
                    RNG.random((3, 4, 5)), U, V, 0.3)
    text = str(found)
    assert "speed_stack" not in text and "target_stack" not in text, text
    assert "target: float64[:, :], active" in text, text


def test_what_nothing_reads_is_not_filled():
    text = differentiate(relaxed, wrt=("f",), of=("f",), engine="numba").adjoint_source(
        RNG.random((3, 4, 5)), U, V, 0.3)
    assert "speed[" not in text and "target[" not in text, text
