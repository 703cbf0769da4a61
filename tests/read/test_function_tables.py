"""Functions that a string picks from a table."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, check, differentiate, gradient
from tests.harness.engines import running
from tests.corpus.calls.function_tables import ACT, X, from_the_module


def default(x, kind="sin"):
    return ACT[kind](x).sum()


def own(x):
    kind = "tanh"
    return (ACT[kind](x) * ACT["sin"](x)).sum()


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_other_keys(engine):
    with running(engine) as name:
        assert check(default, X, engine=name)
        assert check(own, X[:1], engine=name)
        assert check(default, X.astype("float32"), "tanh", engine=name)


def test_a_key_that_is_not_there():
    with pytest.raises(S2sadError, match="'ACT' has no 'relu'"):
        gradient(from_the_module)(X, "relu")


def named_in_vain(x, kind):
    y = x * 2.0
    act = ACT[kind]
    y[0] = 3.0
    return np.sum(y * (act(x) if x[0] < 0.0 else x))


def asked_each_time(x, kind):
    s = 0.0
    while s > 1.0 and x[0] > 0.0:
        f = ACT[kind]
        s = f(s)
    return s + x[0]


def named_where_it_is_called(x, kind):
    y = x[0]
    if x[1] < 5.0:
        y = 2.0 * (ACT[kind](x[0]) if x[0] > 0.0 and x[2] > 0.0 else x[0])
    return y


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_where_a_key_is_asked_for(engine):
    with running(engine) as name:
        with pytest.raises(S2sadError, match="'ACT' has no 'relu'"):
            gradient(differentiate(named_in_vain, engine=name))(X, "relu")
        assert gradient(differentiate(asked_each_time, engine=name))(X, "relu")[0] == 1.0
        with pytest.raises(KeyError):
            gradient(differentiate(named_where_it_is_called, engine=name))(X, "relu")
        assert gradient(differentiate(named_where_it_is_called, engine=name))(-X, "relu")[0] == 2.0


def test_a_table_that_changes(monkeypatch):
    assert np.allclose(gradient(default)(X), np.cos(X))
    monkeypatch.setitem(ACT, "sin", np.cos)
    assert np.allclose(gradient(default)(X), -np.sin(X))
