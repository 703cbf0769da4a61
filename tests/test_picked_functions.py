"""Functions that a string picks from a table."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad import S2sadError, check, differentiate, gradient
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


def in_a_function(x, kind):
    act = ACT[kind]
    twice = lambda v: act(act(v))           # noqa: E731

    def layer(v, w):
        return act(v) * w
    return np.sum(layer(x, 2.0)) + twice(x[0]) + sum([act(v) for v in x])


def in_tests(x, kind, n=2):
    act = ACT[kind]
    s = 2.0 * x[1]
    while act(s) > 0.2 and n < 9:
        s = s * x[2]
        n += 1
    if act(x[0]) > 5.0 or ACT["sin"](x[0]) < act(x[1]):
        s *= act(x[0]) if s > 0.0 else act(x[1])
    return s


def asked_in_tests(x, kind):
    s = 2.0 * x[1]
    while ACT[kind](s) > 0.2 and s < 9.0:
        s = s * x[2]
    if ACT[kind](s) > 5.0:
        s = x[0]
    elif ACT[kind](x[0]) > 0.0:
        s = s * ACT[kind](x[1] if s > 0.0 else x[0])
    for v in ACT[kind](x):
        s += v
    return s


def in_a_branch(x, kind, other="cubed"):
    s = 0.0
    for k in range(3):
        if k > 0:
            f = ACT[kind]
            g = ACT[other]
            s += (f(x[k]) if k > 1 else g(x[0])) * layers(g, x[1], 2) + after(f, g, x[0])
    return s


def after(f, g, v):
    return f(g(v))


@pytest.mark.parametrize(("kernel", "engine"), each([
    from_the_module, written_out, named, handed, in_a_function, in_tests, asked_in_tests, in_a_branch]))
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


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_where_a_key_is_asked_for(engine):
    with running(engine) as name:
        with pytest.raises(KeyError):
            gradient(differentiate(named_in_vain, engine=name))(X, "relu")
        assert gradient(differentiate(asked_each_time, engine=name))(X, "relu")[0] == 1.0


def test_a_table_that_changes(monkeypatch):
    assert np.allclose(gradient(default)(X), np.cos(X))
    monkeypatch.setitem(ACT, "sin", np.cos)
    assert np.allclose(gradient(default)(X), -np.sin(X))


def mixed(x, kind):
    return MIXED[kind](x).sum()


def maybe(x, kind):
    return np.sum(ACT[kind](x) if x[0] > 0.0 else x)


def read_before(x, kind):
    s = 0.0
    for k in range(3):
        if k > 0:
            s += f(x[k])                    # noqa: F821
        f = ACT[kind]                       # noqa: F841
    return s


def used_as_a_value(x, kind):
    act = ACT[kind]
    other = act
    return other(x[0])


@pytest.mark.parametrize("kernel", [maybe, read_before, used_as_a_value])
def test_what_is_to_be_written(kernel):
    with pytest.raises(S2sadError) as refused:
        gradient(kernel)(X, "sin")
    assert "'ACT' cannot be used in a kernel: it is a dict" in str(refused.value)
    assert ("help: bind the function to a name of its own, which is only called: f = ACT[key], where the key is a "
            "parameter, or a name that is bound once") in str(refused.value)


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


def test_a_name_that_means_something_else_elsewhere():
    with pytest.raises(S2sadError):
        gradient(bound_anew)(X, "sin")


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_a_parameter_of_its_name_is_its_own(engine):
    check_derivatives(parameter_of_its_name, (X, "sin"), ("x",), ("return",), engine)


@pytest.mark.parametrize("kernel", [mixed, anew])
def test_what_is_refused(kernel):
    with pytest.raises(S2sadError, match="a call of what an expression gives is not supported in a kernel"):
        gradient(kernel)(X, "sin")
