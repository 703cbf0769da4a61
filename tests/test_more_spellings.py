"""Membership, ranges with names, constants of classes, limits of types, and other spellings of what has a rule."""
from __future__ import annotations

import copy
import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from scipy.linalg import lu
from scipy.special import erfcx

import s2sad
from s2sad import S2sadError, check, differentiate, gradient
from tests.derivatives import check_derivatives
from tests.engines import each, running
from tests.seeds import generator

RNG = generator(4)
X, M = RNG.random(5) + 0.2, RNG.random((5, 2)) + 0.2


def members(x):
    s, n = 0.0, len(x)
    for i in range(n):
        if i in (0, n - 1):
            s += x[i] ** 2
        if i % 3 in (0, 2):
            s += x[i] ** 3
        if i not in (0, n - 1):
            s += x[i]
        if i in (2,):
            s *= x[i]
        if i not in [len(x) - 2, -i + 2]:
            s += x[i] * 0.3
    return s


def ranges(x):
    n = x.size
    steps = range(n)
    inner = range(1, n - 1)
    s = 0.0
    for i in steps:
        s += x[i] ** 2 * i
    for i in reversed(inner):
        s = s * x[i] + x[i + 1]
    for i in range(n)[::-1]:
        s = s * x[i] + x[i]
    for i in steps[1:-1]:
        s = s * x[i] + x[i - 1]
    for i in range(1, n)[::2]:
        s = s * x[i] + x[i - 1]
    for k, i in enumerate(inner):
        s += k * x[i]
    return s * len(steps)


def starred(x, m):
    coef, *_ = np.linalg.lstsq(m, x, rcond=None)
    q, *_ = np.linalg.qr(m)
    return np.sum(coef ** 2) + np.sum(q ** 3)


def limits(x):
    eps = np.finfo(float).eps
    most = np.finfo(np.float64).max * 1e-308
    return np.sum(x / (np.sum(x) + eps)) * most + x[0] * np.iinfo(np.int64).max * 1e-18


def parts_of_numbers(x, t):
    whole, rest = 0.0, 0.0
    part, k = math.modf(3.7 * t)
    fractions, wholes = np.modf(4.0 * x)
    whole, rest = k * part, np.sum(fractions ** 2 * wholes)
    return whole * rest * t


def differences(x, m):
    total = np.sum(np.diff(x, prepend=0.0) ** 2) + np.sum(np.diff(x, prepend=x[0] ** 2, append=2.0) ** 3)
    return total * np.sum(np.diff(m, append=m[:, :1] ** 2) ** 2) * np.linalg.trace(m[:2] @ m[3:])


def stepped(x, f=np.sin, k=2.0):
    return f(x) * k


def cube(x):
    return x ** 3


def cubed(x, f=cube):
    return f(x)


def functions_by_default(x):
    return np.sum(stepped(x)) * np.sum(stepped(x, np.cos)) * np.sum(stepped(x, k=3.0)) + np.sum(cubed(x))


CASES = [
    (members, (X,), ("x",)), (ranges, (X,), ("x",)), (starred, (X, M), ("x", "m")), (limits, (X,), ("x",)),
    (parts_of_numbers, (X, 0.9), ("x", "t")), (differences, (X, M), ("x", "m")),
    (functions_by_default, (X,), ("x",)),
]


@pytest.mark.parametrize(("kernel", "arguments", "wrt", "engine"), each(CASES))
def test_derivatives(kernel, arguments, wrt, engine):
    check_derivatives(kernel, arguments, wrt, ("return",), engine=engine)


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


def by_a_step(x, d):
    s = 0.0
    for i in range(5)[::d]:
        s += x[i] ** 2
    return s


def in_a_loop(x, d):
    s = 0.0
    for k in range(d):
        r = range(k)
        for i in r:
            s += x[i] ** 2
    return s


def picked(x, d):
    r = range(2, 5)
    return x[r[d]] ** 2


PART = "a part of a range that depends on its length, or an item of a range, is not supported in a kernel"


@pytest.mark.parametrize(("kernel", "message", "text"), [
    (by_a_step, PART, "range(5)[::d]"), (picked, PART, "r[d]"),
    (in_a_loop, "a name for a range is not supported in a kernel where the range may change", "range(k)")])
def test_ranges_that_stay(kernel, message, text):
    with pytest.raises(S2sadError) as caught:
        s2sad.gradient(kernel, wrt="x")(X, 2)
    found = caught.value.diagnostics[0]
    assert found.message == message
    assert text in str(caught.value)


def with_erfcx(x, d):
    return erfcx(x[0]) * d


def with_deepcopy(x, d):
    return np.sum(copy.deepcopy(x)) * d


def with_lu(x, d):
    return np.sum(lu(np.outer(x, x), permute_l=True)[0]) * d


@functools.lru_cache(maxsize=8)
def cached(x):
    return x ** 2


def with_a_cache(x, d):
    return cached(x[0]) * d


def by_branches(x, d):
    turned = range(1, 3) if d > 2 else range(2, 0, -1)
    s = 0.0
    for i in turned:
        s += x[i] ** 2
    return s


UNREAD = "'{}' is not a function that s2sad can read"


@pytest.mark.parametrize(("kernel", "message", "help"), [
    (with_erfcx, UNREAD.format("erfcx"), 's2sad.rule("scipy.special.erfcx(x)", x=...)'),
    (with_deepcopy, UNREAD.format("copy.deepcopy"), 's2sad.rule("copy.deepcopy(x)", x=...)'),
    (with_lu, 'no derivative rule for scipy.linalg.lu', 'write factors = lu_factor(a) and lu_solve(factors, b)'),
    (with_a_cache, "'cached' cannot be used in a kernel: it is a function behind a cache, whose results are one object "
     "for all calls", "inner = cached.__wrapped__"),
    (by_branches, "a name for a range is not supported in a kernel where the range may change",
     "write the range where the loop is"),
], ids=lambda v: getattr(v, "__name__", None))
def test_what_is_said_where_the_user_wrote_it(kernel, message, help):
    with pytest.raises(S2sadError) as caught:
        s2sad.gradient(kernel, wrt="x")(X, 2)
    found = caught.value.diagnostics[0]
    assert found.message == message and help in found.help
    assert str(caught.value).startswith(__file__)


def out_of_its_array(x):
    return np.sum(x[-9:2]) * x[0]


def test_a_guard_of_a_slice_names_its_statement():
    with pytest.raises(S2sadError, match=r"(?s)reaches out of its array.*return np.sum\(x\[-9:2\]\) \* x\[0\]"):
        s2sad.gradient(differentiate(out_of_its_array, engine="numpy"))(X)


def numbers_spelled_out(q, k):
    return np.sum((q + (1.0, q[0], 2.0)) * [q[1], 2.0, 3] + k * [1, 2, 3])


def activated(x, f=np.tanh):
    return np.sum(f(x) ** 2)


@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_lists_beside_arrays_and_a_function_that_is_a_default(engine):
    check_derivatives(numbers_spelled_out, (X[:3], np.array([1, 2, 3])), ("q",), ("return",), engine=engine)
    with running(engine) as name:
        assert check(activated, X, engine=name)
