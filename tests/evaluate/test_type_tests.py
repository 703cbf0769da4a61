"""Questions after the type of an argument: answered before the types of branches are joined."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import differentiate, gradient
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
