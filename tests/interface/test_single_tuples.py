"""Functions that return a tuple or a list of one value, as the derivatives that s2sad writes do."""
from __future__ import annotations

import s2sad
from tests.corpus.calls.single_tuples import alone, named, passed_on


def test_what_is_asked_for_returns_what_it_did():
    for kernel in (alone, passed_on, named):
        f = s2sad.differentiate(kernel, engine="numpy")
        assert str(s2sad.jvp(f, (3.0,), {"x": 1.0})) == "{'return': (6.0,)}"
        assert s2sad.vjp(f, (3.0,), {"return": (1.0,)}) == {"x": 6.0}
