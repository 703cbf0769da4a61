"""What objects and items hold as the kernel goes on, and in the end: numbers that begin as constants, properties."""
from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from s2sad import S2sadError, differentiate, gradient, make_zero, vjp
from tests.evaluate.structures.arguments import U, State, state_of
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running


def none_or_not(s):
    best = None
    for i in range(s.size):
        if best is None or s[i] > best:
            best = s[i]
    return best


def picked_by_a_number(s):
    total = 0.0
    for i in range(s.n):
        total += s.layers[i]
    return total


def left_early(s):
    total = 0.0
    for part in s:
        if part.u[0] > 1.0:
            break
        total += part.u[0]
    return total


def replaced_array(s):
    s.u = s.u * 2.0


def int_that_becomes_a_float(s):
    s["n"] += 0.5


def new_key(s):
    s["x"] = 1.0


@dataclass
class Counted:
    total: float
    count: int = 0
    scale: float = 2.0

    @property
    def mean(self):
        return self.total / self.count

    @mean.setter
    def mean(self, value):
        self.total = value * self.count


def items_that_begin_as_constants(x):
    q, d = Counted(1.0), {"sum": 0.0, "power": 2, "last": {"x": 0.0}, "high": False}
    best = {"value": 0.0, "place": 0}
    for i in range(3):
        q.total = q.total * x[i]
        q.count += 1
        q.count = q.count + 1
        d["sum"] += x[i] ** d["power"]
        d["last"]["x"] = d["last"]["x"] + d["sum"]
        if x[i] ** 2 > best["value"]:
            best["value"], best["place"] = x[i] ** 2, i
            d["high"] = x[i] > 1.0
        part = Counted(0.0)
        part.total += x[i] * q.scale
        q.scale = part.total
    return q.total * q.count + d["last"]["x"] * best["value"] * x[best["place"] - 1] * q.scale * (2 if d["high"] else 3)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_items_that_begin_as_constants(engine):
    check_derivatives(items_that_begin_as_constants, (np.array([0.5, 1.2, 0.9]),), ("x",), ("return",), engine)


def property_assigned(q, x):
    q.mean = x[1]
    return q.total * x[2]


def property_of_a_local(x):
    q = Counted(x[0], 2)
    q.mean = x[1]
    return q.total * x[2]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize("kernel, arguments", [(property_assigned, (Counted(0.7, 2), np.array([0.3, 0.5, 0.9]))),
                                               (property_of_a_local, (np.array([0.3, 0.5, 0.9]),))])
def test_a_property_with_a_setter_is_assigned(kernel, arguments, engine):
    with running(engine) as name:
        found = gradient(differentiate(kernel, engine=name), wrt="x")(*arguments)
    assert found == pytest.approx(np.array([0.0, 2.0 * 0.9, 2.0 * 0.5]))
    assert arguments[0] is not Counted or arguments[0].total == 0.7


@dataclass
class Sized:
    a: float

    def __len__(self):
        return 0


def truth_of_its_own(q, x):
    return x[0] if q else x[1] * q.a


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_the_truth_of_an_object_that_defines_it(engine):
    with running(engine) as name:
        assert list(gradient(differentiate(truth_of_its_own, engine=name), wrt="x")(Sized(0.3), np.ones(2))) == [0, 0.3]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_what_structures_hold_in_the_end(engine):
    with running(engine) as name:
        f, g, h = (differentiate(k, engine=name) for k in (none_or_not, picked_by_a_number, left_early))
        assert list(vjp(f, (np.array([1.0, 3.0, 2.0]),), {"return": 2.0})["s"]) == [0, 2, 0]
        found = vjp(g, (SimpleNamespace(n=2, layers=[U, 2.0 * U]),), {"return": np.array([3.0, 4.0])})["s"]
        assert [list(layer) for layer in found.layers] == [[3, 4], [3, 4]]
        parts = tuple(State(np.array([k, 1.0]), U, 0.0) for k in (0.5, 0.7, 1.5, 0.2))
        assert [part.u[0] for part in vjp(h, (parts,), {"return": 1.0})["s"]] == [1, 1, 0, 0]


@pytest.mark.parametrize(("kernel", "s", "seed"), [
    (replaced_array, state_of(), make_zero(state_of())),
    (int_that_becomes_a_float, {"n": 1, "k": 2.0}, {"n": 1, "k": 0.0}),
    (new_key, {"k": 1.0}, {"k": 1.0})])
def test_an_object_that_holds_something_else_in_the_end_is_no_output(kernel, s, seed):
    before = repr(s)
    with pytest.raises(S2sadError) as caught:
        vjp(differentiate(kernel, engine="numpy"), (s,), {"s": seed})
    assert caught.value.diagnostics[0].message == (
        f"'{kernel.__name__}' leaves something else in 's' than was there, which is no output")
    assert repr(s) == before
