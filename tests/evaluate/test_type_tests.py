"""Questions after the type of an argument: answered before the types of branches are joined."""
from __future__ import annotations

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
