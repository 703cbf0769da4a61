"""Functions that return lists: their items come back as those of a tuple do."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.calls.returned_lists import X, made, made_with_more


def in_a_dict(x):
    us = [x[0] * x[1], x[1]]
    return {"u": us, "c": x[2] * x[0]}


def test_seeds_and_tangents():
    def of(f, seed):
        f = s2sad.differentiate(f, engine="numpy")
        return s2sad.jvp(f, (X,), {"x": np.ones(3)})["return"], s2sad.vjp(f, (X,), {"return": seed})["x"].tolist()
    assert of(made, [1.0, 2.0]) == of(made, (1.0, 2.0)) == ([5.0, 1.0], [3.0, 4.0, 0.0])
    assert of(made_with_more, ([1.0, 2.0], 1.0)) == (([5.0, 1.0], 1.0), [3.0, 4.0, 1.0])
    assert of(in_a_dict, {"u": [1.0, 2.0], "c": 1.0}) == ({"u": [5.0, 1.0], "c": 6.0}, [7.0, 4.0, 2.0])
    with pytest.raises(s2sad.S2sadError, match="the seed of 'return' is a list of 3, the result is a list of 2"):
        of(made, [1.0, 2.0, 3.0])
