"""Plain dataclasses whose names are bound anew in loops: nobody assigns to their fields, so none can tell."""
from __future__ import annotations

import pytest

from s2sad import check
from tests.corpus.structures.rebinding import State, X
from tests.harness.engines import running


def given(s, n):
    for _ in range(n):
        s = State(s.u * s.t, s.t + s.u[0])
    return s.u.sum()


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_of_an_argument(engine):
    with running(engine) as name:
        for n in (0, 1, 3):
            assert check(given, State(X.copy(), 0.4), n, engine=name)
    assert check(given, State(X[:1].astype("float32"), 0.4), 2)
