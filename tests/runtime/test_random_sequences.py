"""Draws from a state are those of NumPy's generators, one after the other."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad.evaluate.library import random_numbers
from s2sad.runtime import random_sequences

CALLS = [
    ("normal", (1.0, 2.0, 3)), ("normal", ()), ("uniform", (-1.0, 4.0, (2, 2))), ("random", (4,)),
    ("standard_normal", ((2, 3),)), ("exponential", (2.0, 5)), ("lognormal", (0.1, 0.2, 2)), ("gamma", (2.5, 0.5, 3)),
    ("beta", (2.0, 3.0, 2)), ("poisson", (4.0, 5)), ("binomial", (7, 0.3, 4)), ("choice", (6, 4)),
    ("choice", (6, 4, False)), ("choice", (np.array([0.5, 1.5, 2.5]), 3, True, np.array([0.2, 0.3, 0.5]))),
    ("permutation", (5,)), ("permutation", (np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),)), ("standard_normal", ()),
]
OF_KIND = {
    "Generator": [("integers", (3, 9, 6)), ("integers", (4,)), ("integers", (0, 2, 5))],
    "RandomState": [("randint", (3, 9, 6)), ("rand", (2, 3)), ("randn", ()), ("random_sample", (3,)), ("rand", ())],
}


@pytest.mark.parametrize(("ours", "theirs"), [(random_numbers.Generator, np.random.default_rng),
                                              (random_numbers.RandomState, np.random.RandomState)])
def test_draws_are_those_of_numpy(ours, theirs):
    mine, numpys = ours(42), theirs(42)
    for name, given in (*CALLS, *OF_KIND[ours.__name__], *CALLS):
        if not hasattr(numpys, name):
            continue
        drawn, expected = getattr(mine, name)(*given), getattr(numpys, name)(*given)
        if name == "lognormal":     # the exponential of another library
            np.testing.assert_array_max_ulp(drawn, expected, 1)
        else:
            np.testing.assert_array_equal(drawn, expected, err_msg=name)
    for x in (np.arange(5.0), np.arange(6.0).reshape(3, 2)):
        mine.shuffle(one := x.copy())
        numpys.shuffle(other := x.copy())
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("size", [random_sequences.PCG64, random_sequences.MT19937])
def test_a_state_draws_the_same_again(size):
    state, first, second = np.empty(size, np.int64), np.empty(3), np.empty(3)
    random_sequences.begin(state, 7)
    random_sequences.standard_normal(state, first)      # a normal number is left over
    before = state.copy()
    random_sequences.standard_normal(state, first)
    state[...] = before
    random_sequences.standard_normal(state, second)
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(state, before)
