"""Guards of sizes: what they say, and where they are too strict."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad


def row_at_a_counter_of_two_loops(x, y):
    for i in range(1, -1, -1):
        y[...] = x[i:i + 1]
    for i in range(x.size, -1, -1):
        y[0] += x[0] * i
    return y[0] * i


def end_of_a_part(x, m):
    part = m[-1, :3]
    m += part[-1:][None, :]


@pytest.mark.parametrize(("kernel", "arguments", "seeds"), [
    (row_at_a_counter_of_two_loops, (np.ones(4), np.ones(4)), {"y": np.ones(4)}),
    (end_of_a_part, (np.ones(4), np.ones((4, 4))), {"m": np.ones((4, 4))})])
def test_a_length_of_one_that_is_not_seen(kernel, arguments, seeds):
    """A limitation: NumPy repeats these parts; their length of 1 is not known where the guard is written."""
    with pytest.raises(s2sad.S2sadError, match="(?s)shapes differ.*a length of 1 repeats only where it is written"):
        s2sad.vjp(s2sad.differentiate(kernel, engine="numpy"), arguments, seeds)


def last_two(x, y):
    x[-2:] *= y


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_guards_say_what_to_do(engine):
    derivative = s2sad.differentiate(wrt="x", of=("x",), engine=engine)(last_two)
    for size, words in ((1, "a slice reaches out of its array"), (3, "shapes differ")):
        with pytest.raises(s2sad.S2sadError, match=words):
            s2sad.vjp(derivative, (np.ones(size), np.ones(size)), {"x": np.ones(size)})
