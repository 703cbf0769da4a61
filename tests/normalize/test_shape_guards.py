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


def read_by_a_mask(x, m):
    return np.sum(x[m])


def written_by_a_mask(x, m):
    y = np.zeros(3)
    y[m] += 3.0 * x[0]
    return np.sum(y)


def changed_by_a_mask(x, m):
    x[m] *= x[1]
    return np.sum(x ** 2)


def rows_by_a_mask(x, m):
    a = np.outer(x, x)
    a[:, m] += x[0]
    return np.sum(a[m] ** 2)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize("kernel", [read_by_a_mask, written_by_a_mask, changed_by_a_mask, rows_by_a_mask])
def test_masks_of_another_size(kernel, engine):
    """NumPy raises; loops over a longer mask would go on behind the array, also after a call that was right."""
    f = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=engine), "x")
    for _ in range(2):
        for m in ([True, False], [True, False, True, True, True], [True, False, True]):
            x, mask = np.array([0.3, 0.8, -0.4]), np.array(m)
            if len(m) == 3:
                value, gradient = f(x, mask)
                assert value == pytest.approx(kernel(x.copy(), mask), rel=1e-14)
                slope = [(kernel(x + h, mask) - kernel(x - h, mask)) / 2e-6 for h in 1e-6 * np.eye(3)]
                np.testing.assert_allclose(gradient, slope, rtol=1e-6, atol=1e-8)
                continue
            with pytest.raises((ValueError, IndexError), match="an array of bools has another|boolean index did not"):
                f(x, mask)


def table(x, xp, fp):
    return np.interp(x[0], xp, fp) + np.sum(np.interp(x, xp, fp))


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_a_table_with_fewer_values_than_places(engine):
    f = s2sad.gradient(s2sad.differentiate(table, engine=engine), "x")
    x, xp = np.array([0.3, 0.8]), np.array([0.0, 1.0, 2.0])
    np.testing.assert_array_equal(f(x, xp, np.array([0.0, 2.0, 3.0])), [4.0, 2.0])
    with pytest.raises(s2sad.S2sadError, match="there are not as many places, or values, along one axis"):
        f(x, xp, np.array([0.0, 2.0]))
