"""shared_reciprocals: which divisions of an adjoint become products, and what keeps its digits."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.loops.shared_reciprocals import (
    divided_on_one_side, divisor_moves, divisor_of_a_loop, of_a_helper, place_of_a_quotient, quotients,
)
from tests.harness.engines import running
from tests.optimize.test_levels import texts

X = np.ones(4)


@pytest.mark.parametrize(("kernel", "arguments", "divided"), [
    (quotients, (X, X, 1.5, X), ["1.0 / d", "1.0 / y[i]", "x[i] / y[i]"]),
    (divisor_moves, (X, 1.5, X), ["1.0 / s", "1.0 / s_1"]),
    (place_of_a_quotient, (X, 1.5, X), ["1.0 / d", "x[i] / d"]),
    (divided_on_one_side, (X, 1.5, X), ["1.0 / (d * d)", "1.0 / d"]),
    (divisor_of_a_loop, (X, X), ["1.0 / s"]),
    (of_a_helper, (X, X), ["1.0 / a", "1.0 / b"])])
def test_what_is_divided(kernel, arguments, divided):
    wrt = tuple(n for n in kernel.__code__.co_varnames[:len(arguments)] if n != "z")
    text = texts(kernel, arguments, wrt, ("z",))[1].text.partition("# reverse sweep")[2]
    lines = [line for line in text.splitlines() if " / " in line and "#" not in line]
    assert sorted(line.partition(" = ")[2] for line in lines) == divided


def test_a_place_is_found_again():
    """1.0 / 49.0 * 49.0 is less than 1: the seed of another element would be taken."""
    assert int(49.0 * (1.0 / 49.0)) == 0
    with running("loops"):
        found = s2sad.vjp(s2sad.differentiate(place_of_a_quotient, wrt=("x",), of=("z",), engine="numba"),
                          (np.array([49.0]), 49.0, np.zeros(2)), {"z": np.array([0.0, 1.0])})
    assert found["x"] == pytest.approx([2.0 / 49.0 ** 2])
