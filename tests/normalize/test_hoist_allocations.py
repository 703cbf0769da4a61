"""Work arrays that each iteration writes anew, in loops that run forward and back per iteration: where nothing but the
reverse sweep needs them, they are still allocated."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.engines import each, running


def indices(a):
    """The indices of two elements are stored anew for each of the others."""
    k, total = np.empty(2, dtype=np.int64), 0.0
    for c in range(a.size):
        for j in range(2):
            k[j] = j
        total += a[k[0]] * a[k[1]] * a[c]
    return total


def numbers(a):
    """As `indices`, with numbers."""
    w, total = np.empty(2), 0.0
    for c in range(a.size):
        for j in range(2):
            w[j] = 2.0 + j
        f = a[c] * w[0]
        total += f * a[c] * w[1]
    return total


def chosen(a):
    """A permutation for each number, by the numbers of its places."""
    place, total = np.empty(a.size, dtype=np.int64), 0.0
    for c in range(a.size):
        for j in range(a.size):
            place[j] = j
        other = c % (a.size - 1) + 1
        place[0], place[other] = place[other], place[0]
        factor = 1.0
        for i in range(2):
            factor *= a[place[i]] if i % 2 == 0 else -a[place[i]]
        total += factor
    return total


@pytest.mark.parametrize(("kernel", "engine"), each([indices, numbers, chosen]))
def test_adjoint_without_the_value(kernel, engine):
    a = np.array([1.5, 2.0, 3.0, 0.5])
    step = 1e-30j * np.eye(a.size)
    expected = [kernel(a + s).imag / 1e-30 for s in step]
    a_bar = np.zeros(a.size)
    with running(engine) as chosen_engine:
        s2sad.differentiate(kernel, wrt="a", of="return", engine=chosen_engine).adjoint(a, a_bar, 1.0)
    assert a_bar == pytest.approx(expected, rel=1e-14)
    assert s2sad.gradient(s2sad.differentiate(kernel, engine="numpy"))(a) == pytest.approx(expected, rel=1e-14)
