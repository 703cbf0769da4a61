"""Questions after the type of an argument: answered before the types of branches are joined."""
from __future__ import annotations

from collections import deque

import numpy as np
import pytest

from s2sad import S2sadError, differentiate, gradient, value_and_gradient
from tests.harness.engines import running
from tests.corpus.branches.type_tests import X


class Given:
    def __init__(self, u, m):
        self.u, self.m = u, m


def nothing_in_a_structure(s):
    if isinstance(s.m, np.ndarray):
        return s.u @ s.m
    return s.u @ s.u if isinstance(s.m, type(None)) else s.u.sum() * s.m


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_nothing_in_a_structure(engine):
    with running(engine) as under:
        for m, expected in ((None, 2.0 * X), (0.5, 0.5 * np.ones(3)), (X[::-1] * 1.0, X[::-1])):
            found = gradient(differentiate(nothing_in_a_structure, engine=under))(Given(X.copy(), m))
            np.testing.assert_allclose(found.u, expected, rtol=1e-14)


def lengthy(x):
    if hasattr(x, "__len__"):
        return np.sum(x ** 2)
    return x ** 3


def shaped(x):
    return np.sum(x * 2.0) if hasattr(x, "shape") else x * 3.0


def test_what_a_number_has_and_an_array_does_not():
    f = gradient(differentiate(lengthy, engine="numpy"))
    assert f(2.0) == 12.0 and f(3.0) == 27.0
    np.testing.assert_array_equal(f(np.array([1.0, 2.0])), [2.0, 4.0])
    f = gradient(differentiate(shaped, engine="numpy"))
    np.testing.assert_array_equal(f(np.ones(2)), 2.0)
    with pytest.raises(S2sadError, match="whether this has 'shape' must be known before the run"):
        f(2.0)      # a float of Python's has none, one of NumPy's has


def called_or_read(x):
    if hasattr(x, "__call__") or hasattr(x[0], "__name__") or hasattr(x, "mro"):     # noqa: B004
        return 0.0
    return x[0]


def test_what_a_type_has_its_objects_do_not():
    value, found = value_and_gradient(differentiate(called_or_read, engine="numpy"))(np.array([1.5, 0.7]))
    assert value == 1.5
    np.testing.assert_array_equal(found, [1.0, 0.0])


def kinds_of_lists(x):
    us = [v for v in x if v > 0.5]
    last, s = deque(maxlen=2), 0.0
    for v in us:
        last.append(v)
    more = us[1:]
    for item in (us, more, last, x[0]):
        if isinstance(item, list):
            s += sum(item)
        elif hasattr(item, "appendleft"):
            s += 10.0 * sum(item)
        elif not isinstance(item, (deque, tuple)):
            s += 100.0 * item
    return s


def kind_of_a_row(x):
    rows = []
    for v in x:
        if v > 0.5:
            rows.append([v, 1.0])
    return rows[0][0] * (2.0 if isinstance(rows[0], list) else 1.0)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_lists_of_the_run_are_lists(engine):
    with running(engine) as under:
        x = np.array([0.7, 0.2, 0.9])
        value, found = value_and_gradient(differentiate(kinds_of_lists, engine=under))(x)
        assert value == pytest.approx(kinds_of_lists(x))
        np.testing.assert_allclose(found, [111.0, 0.0, 12.0])
        with pytest.raises(S2sadError, match="whether something is a list or a tuple is asked"):
            gradient(differentiate(kind_of_a_row, engine=under))(x)
