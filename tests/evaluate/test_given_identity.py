"""Objects that are given twice, dicts in another order, attributes that a class assigns its own way."""
from __future__ import annotations

from collections import namedtuple
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from s2sad import differentiate, gradient
from s2sad.diagnostics import S2sadError
from s2sad.dispatch import artifacts

X = np.array([1.0, 2.0])


def derived(function) -> Any:
    return gradient(differentiate(function, engine="numpy"), wrt="x")


def which(x, p, q):
    return x[0] if p is q else x[1]


def test_one_object_under_two_names():
    found, one = derived(which), SimpleNamespace(v=1.0)
    for p, q, same in ((one, SimpleNamespace(v=1.0), False), (one, one, True), (X, X, True), (X, X.copy(), False)):
        np.testing.assert_array_equal(found(X.copy(), p, q), [1.0, 0.0] if same else [0.0, 1.0])


def inside(x, s):
    return x[0] if s.grid is s.boundary.grid else x[1]


def pairs(x, grids):
    return sum(x[0] if a is b else x[1] for a in grids for b in grids)


def test_one_object_in_two_places():
    grid = SimpleNamespace(n=2.0)
    shared = SimpleNamespace(grid=grid, boundary=SimpleNamespace(grid=grid))
    np.testing.assert_array_equal(derived(inside)(X, shared), [1.0, 0.0])
    np.testing.assert_array_equal(derived(pairs)(X, [grid, grid]), [4.0, 0.0])
    np.testing.assert_array_equal(derived(pairs)(X, [grid, SimpleNamespace(n=1.0)]), [2.0, 2.0])


def in_order(x, d):
    return sum((i + 1) * v * x[i] for i, v in enumerate(d.values()))


First, Second = namedtuple("Pair", "a b"), namedtuple("Pair", "b a")


def by_name(x, p):
    return p[0] * x[0] + p.a * x[1]


def test_dicts_and_named_tuples_in_another_order(monkeypatch, tmp_path):
    monkeypatch.setattr(artifacts, "ENABLED", True)
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path))
    for _ in range(2):
        np.testing.assert_array_equal(derived(in_order)(X, {"a": 1.0, "b": 2.0}), [1.0, 4.0])
        np.testing.assert_array_equal(derived(in_order)(X, {"b": 2.0, "a": 1.0}), [2.0, 2.0])
        np.testing.assert_array_equal(derived(by_name)(X, First(1.0, 2.0)), [1.0, 1.0])
        np.testing.assert_array_equal(derived(by_name)(X, Second(1.0, 2.0)), [1.0, 2.0])


def through(x, given):
    return given.f(x[0]) * x[1]


def test_functions_in_structures_where_derivatives_are_kept(monkeypatch, tmp_path):
    """No description identifies them in another process: what is derived is not kept."""
    monkeypatch.setattr(artifacts, "ENABLED", True)
    monkeypatch.setenv("S2SAD_CACHE_DIR", str(tmp_path))
    for factor in (3.0, 5.0):
        found = derived(through)(X, SimpleNamespace(f=lambda v, factor=factor: factor * v))
        np.testing.assert_array_equal(found, factor * X[::-1])


class Body:
    def __init__(self, heat):
        self._heat = heat

    @property
    def heat(self):
        return self._heat

    @heat.setter
    def heat(self, value):
        self._heat = value * value


def heated(x):
    body = Body(x)
    body.heat += 1.0
    return np.sum(body.heat)


def test_a_setter_is_called_by_augmented_assignments():
    np.testing.assert_allclose(derived(heated)(X.copy()), 2.0 * (X + 1.0))


class Tripled:
    def __set_name__(self, owner, name):
        self.name = "_" + name

    def __get__(self, instance, owner=None):
        return getattr(instance, self.name)

    def __set__(self, instance, value):
        setattr(instance, self.name, 3.0 * value)


class Material:
    k = Tripled()

    def __init__(self, k):
        self.k = k


class Doubling(type):
    def __call__(cls, *arguments):
        made = super().__call__(*arguments)
        made.v = 2.0 * made.v
        return made


class Made(metaclass=Doubling):
    def __init__(self, v):
        self.v = v


def with_descriptor(x):
    return Material(x[0]).k


def with_metaclass(x):
    return Made(x[0]).v


@pytest.mark.parametrize(("kernel", "said"), [
    (with_descriptor, "'k' of class Material is a descriptor of class Tripled"),
    (with_metaclass, "'Made' is made by a class of its own: Doubling")])
def test_classes_that_do_more(kernel, said):
    with pytest.raises(S2sadError) as caught:
        derived(kernel)(X)
    assert caught.value.diagnostics[0].message == said


TABLE = {(0, 1): 2.0, "b c": 3.0, -1: 4.0}


def from_table(x):
    return TABLE[0, 1] * x[0] + TABLE["b c"] * x[1] + TABLE[-1]


def test_keys_that_are_no_names():
    np.testing.assert_array_equal(derived(from_table)(X), [2.0, 3.0])


def of_one_of_two(x, p, q):
    one = p if x[0] > x[1] else q
    one.v[0] = one.v[0] * x[0]
    return p.v[0] + 3.0 * q.v[0] * x[1]


def test_one_of_two_given_objects():
    for x in ([2.0, 1.0], [1.0, 2.0]):
        p, q = SimpleNamespace(v=np.array([1.5])), SimpleNamespace(v=np.array([0.5]))
        found = gradient(differentiate(of_one_of_two, engine="numpy"), wrt="x")(np.array(x), p, q)
        np.testing.assert_allclose(found, [1.5, 1.5] if x[0] > x[1] else [1.5 * x[1], 1.5 * x[0]])
