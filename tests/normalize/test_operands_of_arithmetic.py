"""What is no number is not computed with, and what is no integer is no index: both are said with their place."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.engines import one_line
from tests.normalize.test_operand_types import INDEX, element


def times(u, k):
    return np.sum(k * u ** 2)


def power(u, k):
    return np.sum(u) ** k


def negative(u, k):
    return -k * u[0]


def sine(u, k):
    return np.sin(k) * u[0]


def compared(u, k):
    return u[0] if k > 1 else u[1]


def filled(u, k):
    v = np.zeros(3)
    v[:] = k
    return np.sum(v * u)


def chosen(u, k):
    return np.sum(np.where(u > k, u, 0.0))


def bound(u, k):
    n = k + 1
    return u[n]


def larger(u, k):
    return max(u[0], k)


def added(u, k):
    u[0] += k
    return u[0]


def _times(u, k):
    return u[0] * k


def handed(u, k):
    return _times(u, k)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("value, said", [(None, "None"), ("x", "a str")])
@pytest.mark.parametrize("kernel", [
    times, power, negative, sine, compared, filled, chosen, bound, larger, added, handed])
def test_what_is_no_number(kernel, value, said, engine):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(s2sad.differentiate(kernel, engine=engine), "u")(np.ones(3), value)
    (found,) = caught.value.diagnostics
    assert (found.code, found.message, found.help) == (
        "S405", f"the argument 'k' is {said}, and it is computed with", "give a number or an array")
    assert "k" in found.span.source.line(found.span.line)


def places(u, k):
    return u[k]


def test_none_under_a_name_is_no_index():
    with pytest.raises(s2sad.S2sadError, match="the argument 'k' is None, and an index is an integer"):
        s2sad.gradient(places, "u")(np.ones(3), None)


def element_of_rows(u, v):
    v[0] = u[0]
    return v[0]


def test_an_array_is_no_element():
    with pytest.raises(s2sad.S2sadError, match=r"S203.*: float64\[:\] is stored in an element"):
        s2sad.gradient(element_of_rows, "u")(np.ones((2, 1)), np.zeros(2))


def stored(u, k):
    v = np.zeros(3)
    v[k > 1] = u[0]
    return np.sum(v)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_an_array_is_not_indexed_with_a_bool(engine):
    """NumPy makes another axis of it, Numba has no such index."""
    u = np.array([0.5, -1.5, 2.0])
    for kernel, k, expected in (
            (element, True, "the argument 'k' is a bool, and an index is an integer: give an int, or write int(k)"),
            (stored, 2, f"a bool, where an index is an integer: {INDEX}")):
        with pytest.raises(s2sad.S2sadError) as error:
            s2sad.gradient(s2sad.differentiate(kernel, engine=engine), wrt="u")(u, k)
        assert one_line(error.value) == expected
