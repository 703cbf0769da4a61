"""Functions that a string picks from a table."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, check, gradient
from tests.derivatives import check_derivatives
from tests.engines import each, running

X = np.array([0.3, 1.1, 0.7])


def cubed(x):
    return x ** 3


ACT = {"tanh": np.tanh, "sin": np.sin, "cubed": cubed}
MIXED = {"sin": np.sin, "number": 2.0}


def from_the_module(x, kind):
    return (ACT[kind](x) * x).sum() + ACT[kind](x[0])


def written_out(x, kind):
    return {"tanh": np.tanh, "sin": np.cos, "cubed": cubed}[kind](x * 2.0).sum()


def named(x, kind):
    act = ACT[kind]
    s = 0.0
    for i in range(3):
        s += act(x[i]) * act(s)
    return s


def layers(f, x, n):
    for _ in range(n):
        x = f(x) + 0.1
    return x


def handed(x, kind):
    act = ACT[kind]
    return layers(act, x, 2).sum() * layers(ACT[kind], x[1], 1)


@pytest.mark.parametrize(("kernel", "engine"), each([from_the_module, written_out, named, handed]))
def test_picked_functions(kernel, engine):
    for kind in ("tanh", "cubed"):
        check_derivatives(kernel, (X, kind), ("x",), ("return",), engine=engine)


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
    with pytest.raises(KeyError):
        gradient(from_the_module)(X, "relu")


def test_a_table_that_changes(monkeypatch):
    assert np.allclose(gradient(default)(X), np.cos(X))
    monkeypatch.setitem(ACT, "sin", np.cos)
    assert np.allclose(gradient(default)(X), -np.sin(X))


def mixed(x, kind):
    return MIXED[kind](x).sum()


def anew(x, kind):
    s = ACT[kind](x).sum()
    kind = "sin"
    return s + ACT[kind](x).sum()


def bound_anew(x, kind):
    def g(v):
        return v * 2.0
    act = {"sin": g, "tanh": np.tanh}[kind]

    def g(v):
        return v * 3.0
    return np.sum(act(x)) * g(x[0])


def parameter_of_its_name(x, kind):
    act = ACT[kind]

    def layer(act, v):
        return act(v) * 2.0
    return act(x[0]) * layer(np.cos, x[1])


@pytest.mark.parametrize("kernel", [bound_anew, parameter_of_its_name])
def test_names_that_mean_something_else_elsewhere(kernel):
    with pytest.raises(S2sadError):
        gradient(kernel)(X, "sin")


@pytest.mark.parametrize("kernel", [mixed, anew])
def test_what_is_refused(kernel):
    with pytest.raises(S2sadError, match="a call of what an expression gives is not supported in a kernel"):
        gradient(kernel)(X, "sin")
