"""Membership, ranges with names, constants of classes, limits of types, and other spellings of what has a rule."""
from __future__ import annotations

import copy
import functools
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from scipy.linalg import lu
from scipy.special import erfcx

import s2sad
from s2sad import S2sadError, check, differentiate, gradient
from tests.corpus.language.ranges import X
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running


class Scaled:
    scale = 2.5
    kind = "a"

    def __init__(self, x):
        self.x = x

    def value(self):
        return self.x * self.scale


@dataclass
class Power:
    x: float
    c: ClassVar[float] = 1.5
    d = 3


def constants_of_classes(s, p):
    return s.value() * s.scale * p.x ** p.d * p.c if s.kind == "a" else s.x


def test_constants_of_classes_are_read_and_watched():
    s, p = Scaled(0.3), Power(0.7)
    assert check(constants_of_classes, s, p, engine="numpy")
    f = gradient(differentiate(constants_of_classes, engine="numpy"), wrt="s.x")
    before = f(s, p)
    try:
        Scaled.scale = 5.0
        assert np.isclose(f(s, p), 4.0 * before)
    finally:
        Scaled.scale = 2.5
    assert f(s, p) == before


def with_erfcx(x, d):
    return erfcx(x[0]) * d


def with_lu(x, d):
    return np.sum(lu(np.outer(x, x), permute_l=True)[0]) * d


@functools.lru_cache(maxsize=8)
def cached(x):
    return [x ** 2]


def with_a_cache(x, d):
    return cached(x[0])[0] * d


def by_branches(x, d):
    turned = range(1, 3) if d > 2 else range(2, 0, -1)
    s = 0.0
    for i in turned:
        s += x[i] ** 2
    return s


UNREAD = "'{}' is not a function that s2sad can read"


@pytest.mark.parametrize(("kernel", "message", "help"), [
    (with_erfcx, UNREAD.format("erfcx"), 's2sad.rule("scipy.special.erfcx(x)", x=...)'),
    (with_lu, 'no derivative rule for scipy.linalg.lu', 'write factors = lu_factor(a) and lu_solve(factors, b)'),
    (with_a_cache, "a function behind a cache, which is more than one of numbers, or reads what may change",
     "inner = f.__wrapped__"),
], ids=lambda v: getattr(v, "__name__", None))
def test_what_is_said_where_the_user_wrote_it(kernel, message, help):
    with pytest.raises(S2sadError) as caught:
        s2sad.gradient(kernel, wrt="x")(X, 2)
    found = caught.value.diagnostics[0]
    assert found.message == message and help in found.help
    assert str(caught.value).startswith(__file__)


def numbers_spelled_out(q, k):
    return np.sum((q + (1.0, q[0], 2.0)) * [q[1], 2.0, 3] + k * [1, 2, 3])


def activated(x, f=np.tanh):
    return np.sum(f(x) ** 2)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_lists_beside_arrays_and_a_function_that_is_a_default(engine):
    check_derivatives(numbers_spelled_out, (X[:3], np.array([1, 2, 3])), ("q",), ("return",), engine=engine)
    with running(engine) as name:
        assert check(activated, X, engine=name)
        for d in (2, 3):
            assert check(by_branches, X, d, engine=name)


class Held:
    def __init__(self, u):
        self.u, self.parts = u, [u, u * 2.0]


def of_deep_copies(x):
    held = Held(x * x)
    other = copy.deepcopy(held)
    other.u[0] = 3.0 * x[1]
    return np.sum(held.u * other.parts[0]) + np.sum(other.parts[1] * copy.deepcopy(x))


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_deep_copies_are_copies(engine):
    check_derivatives(of_deep_copies, (np.array([0.4, 1.3, 0.7]),), ("x",), ("return",), engine)
