"""An axis that a name of the module stands for is compared at each call."""
from __future__ import annotations

import numpy as np

import s2sad

ROWS = 1


def test_a_number_of_the_module_that_is_changed(monkeypatch):
    f = s2sad.gradient(of_the_module)
    a = np.arange(6.0).reshape(2, 3)
    first = f(a)
    monkeypatch.setitem(globals(), "ROWS", 0)
    np.testing.assert_allclose(first, 2.0 * np.roll(np.roll(a, 1, 1), -1, 1) * np.sum(a * 0.0 + 1.0) / 6.0)
    assert not np.allclose(f(np.cumsum(a, axis=0)), first)


def of_the_module(a):
    return np.sum(np.roll(a, 1, axis=ROWS) ** 2)
