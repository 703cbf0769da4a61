"""Kernels as people bring them: each holds several things that were once refused, or differentiated wrongly."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.corpus.combinations.as_users_write import CASES
from tests.harness.derivatives import check_value

TABLE = {"drag": 0.4, "layer": {"depth": [1.0, 2.0]}}


class Settings:
    gravity = 9.81
    profile = (1.0, 0.5)


def settled(x):
    return np.sum(x) * TABLE["drag"] + TABLE["layer"]["depth"][1] * x[0] + Settings.profile[0] * Settings.gravity * x[1]


def test_constants_in_dicts_lists_and_classes(monkeypatch):
    gradient = s2sad.gradient(s2sad.differentiate(settled, engine="numpy"))

    def expected():
        return TABLE["drag"] + np.array([TABLE["layer"]["depth"][1], Settings.profile[0] * Settings.gravity, 0.0])
    np.testing.assert_allclose(gradient(np.ones(3)), expected())
    for holder, key, value in ((TABLE, "drag", 3.0), (TABLE["layer"], "depth", [2.0, 5.0])):
        monkeypatch.setitem(holder, key, value)
        np.testing.assert_allclose(gradient(np.ones(3)), expected())
    TABLE["layer"]["depth"][1] = 7.0
    np.testing.assert_allclose(gradient(np.ones(3)), expected())
    monkeypatch.setattr(Settings, "gravity", 1.0)
    np.testing.assert_allclose(gradient(np.ones(3)), expected())


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("kernel", "arguments", "outputs"), CASES, ids=lambda c: getattr(c, "__name__", ""))
def test_the_value_beside_the_gradient(kernel, arguments, outputs, engine):
    code = kernel.__code__
    inputs = tuple(n for n, a in zip(code.co_varnames, arguments) if np.asarray(a).dtype.kind == "f")
    check_value(kernel, arguments, inputs, engine)
