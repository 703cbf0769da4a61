"""Loops over written numbers: over arrays of them where that is the same, written out where a number must be known."""
from __future__ import annotations

import s2sad
from tests.corpus.loops.literal_iterables import A, X, forces


def test_stays_a_loop():
    text = s2sad.differentiate(forces, engine="numpy").adjoint_source(A, X)
    assert text.count("for index in range(") == 2, text
    assert text.count("a_bar[j] += ") == 1, text
