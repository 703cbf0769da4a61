"""Named tuples, dataclasses and objects whose classes define operators, items and lengths of their own."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError
from tests.harness.engines import running


class Vec(NamedTuple):      # noqa: PLW1641
    x: float
    y: float

    def __add__(self, o):
        return Vec(self.x + o.x, self.y + 2.0 * o.y)

    def __sub__(self, o):
        return Vec(self.x - o.x, self.y - o.y)

    def __mul__(self, s):
        return Vec(self.x * s, self.y * s)

    __rmul__ = __mul__

    def __truediv__(self, s):
        return Vec(self.x / s, self.y / s)

    def __matmul__(self, o):
        return self.x * o.x + self.y * o.y

    def __neg__(self):
        return Vec(-self.x, -self.y)

    def __abs__(self):
        return math.hypot(self.x, self.y)

    def __eq__(self, o):
        return abs(self.x - o.x) < 0.1

    def __lt__(self, o):
        return self.x * self.y < o.x

    def __gt__(self, o):
        return self.y > 3.0 * o.y

    def __len__(self):
        return 5

    def __getitem__(self, i):
        return self.x * (i + 2)


class Other(NamedTuple):
    x: float
    y: float

    def __mul__(self, o):
        return 2.0 * self.x

    def __rmul__(self, o):
        return 3.0 * self.x


class Narrower(Other):
    def __rmul__(self, o):
        return 5.0 * self.x * o.y


class Gone(NamedTuple):
    x: float
    y: float

    def __iter__(self):
        return iter((10.0, 20.0))


@dataclass
class Grid:
    x: np.ndarray
    h: float

    def __len__(self):
        return self.x.size

    def __getitem__(self, i):
        return self.x[i] * self.h

    def __iadd__(self, o):
        self.x += o
        self.h += 1.0
        return self

    def __add__(self, o):
        return Grid(self.x + o, self.h * 2.0)

    def __rmul__(self, k):
        return k * self.h

    def mean(self):
        return np.sum(self.x) / len(self)


def made_here(a, b):
    s = Vec(a, b) + Vec(b, a * a)
    return s.x ** 2 + s.y ** 2


def lengths(v, w):
    return len(v + w) * v.x + v[1] * w.y


def inside(v, w):
    return ((v - w) / 2.0 + w * v.x) @ (-w) + (3 * v).y ** 2 + abs(w) * (v * 0.5).x ** 2


def summed(vs):
    t = vs[0]
    for w in vs[1:]:
        t = t + w
    return t.x ** 2 + t.y


def compared(v, w):
    if v == w:
        return v.x
    if v > w:
        return v.x ** 2
    return v.x ** 3 if v < w else w.y ** 3


def bound_anew(v, w, n):
    v += w
    for _ in range(n):
        v = v + w * 0.1
    for i in range(len(v)):
        v = v * (1.0 + (w * i).x)
    return v.x * v.y


def grid_mean(g):
    s = 0.0
    for i in range(len(g)):
        s += g[i] ** 2 * g[i - 1]
    return s * g.mean() * (2.0 * g)


def grid_grown(g, a):
    k = g + a
    g += a
    return g[1] * g.h + k[2] * k.h + np.sum(k.x * g.x)


class Wave:
    def __init__(self, k):
        self.k = k

    def __call__(self, t, shift=0.0):
        return math.sin(self.k * t + shift)


class Driven:
    def __init__(self, source):
        self.source = source

    def force(self, t):
        return 2.0 * self.source(t)


def called_fields(s, t):
    return s.force(t) * s.source(t, shift=0.3)


def narrower(v, w):
    return v * w + w * v


def outer_field(v, a):
    return v.x * v.y * a


V, W = Vec(0.3, 0.4), Vec(0.5, 0.7)


def grid():
    return Grid(np.array([0.3, 0.5, 0.8]), 0.6)


TAKEN = [
    (made_here, (0.3, 0.4)), (lengths, (V, W)), (inside, (V, W)), (summed, ([V, W, W],)), (compared, (V, W)),
    (compared, (Vec(0.5, 3.0), W)), (compared, (V, Vec(0.35, 0.7))), (bound_anew, (V, W, 3)), (grid_mean, (grid(),)),
    (grid_grown, (grid(), 0.2)), (called_fields, (Driven(Wave(0.7)), 0.4)),
    (narrower, (Other(0.3, 0.4), Narrower(0.5, 0.6))),
    (outer_field, (Gone(0.3, 0.4), 0.5)), (outer_field, (V, 0.5)),
]


@pytest.mark.parametrize(("kernel", "arguments"), TAKEN, ids=[f"{k.__name__}{n}" for n, (k, _) in enumerate(TAKEN)])
@pytest.mark.parametrize("engine", ["numpy", "loops"])
def test_methods_are_called_where_operators_stand(kernel, arguments, engine):
    with running(engine) as name:
        found = s2sad.check(kernel, *arguments, engine=name)
    assert found, str(found)


def test_a_method_is_called_by_compiled_code():
    assert s2sad.check(inside, V, W, engine="numba")


def number_on_the_left(v, dt):
    return (dt * v).x


def unpacked(g, dt):
    p, q = g
    return p * q * dt


def looped(g, dt):
    s = 0.0
    for k in g:
        s += k
    return s * dt


def as_an_array(g, dt):
    return np.sum(np.array(g)) * dt


def truth(v, dt):
    return v.x * dt if v else dt


def greatest(v, dt):
    return max(v, Vec(dt, dt)).x


def in_their_order(v, dt):
    return sorted([v, Vec(2.0, dt)])[0].x * dt


def as_a_bool(v, dt):
    return bool(v) * dt


def turned(v, dt):
    s = 0.0
    for k in reversed(v):
        s = s * dt + k
    return s


def chained(v, dt):
    return dt if v < v < v else v.x


def in_an_arm(v, dt):
    return (v * 2.0).x if dt > 2.0 else v.x


def unequal(g, dt):
    return dt if g != g else g.h


def unpacked_fields(g, dt):
    p, q = g
    return np.sum(p) * q * dt


class Equal:        # noqa: PLW1641
    def __init__(self, h):
        self.h = h

    def __eq__(self, o):
        return self.h > 0.0


class Plain:
    def __init__(self, h):
        self.h = h


def length_of_fields(g, dt):
    return len(g) * dt


class Given(NamedTuple):
    x: float
    y: float
    __add__ = math.hypot        # pyright: ignore


def no_method(v, dt):
    return (v + v) * dt


class Both:        # noqa: PLW1641
    def __init__(self, h):
        self.h = h

    def __eq__(self, o):
        return NotImplemented

    def __ne__(self, o):
        return self.h > 0.0


def not_equal(g, dt):
    other = Both(dt)
    return dt ** 2 if g != other else dt + (g == other)


class Inner:
    def __init__(self, h):
        self.h = h

    def __add__(self, o):
        return 2.0 * self.h + o.h

    def __radd__(self, o):
        return 3.0 * self.h + o.h


class Outer(Inner):
    def __radd__(self, o):
        return 5.0 * self.h + o.h


def right_first(g, dt):
    """A class that is derived from the other operand's is asked first."""
    return (Inner(dt) + g) * dt + (g + Inner(dt))


@dataclass
class Same:
    a: float
    b: float = field(compare=False)


def as_fields(g, dt):
    p, q = Same(dt, 1.0), Same(dt, 2.0)
    return dt ** 3 if p == q and g == g and not p != q else dt


class Clock:
    def __init__(self, end):
        self.end, self.t = end, 0.0

    def __iter__(self):
        return self

    def __next__(self):
        if self.t >= self.end:
            raise StopIteration
        self.t += 0.3
        return self.t


def its_own_iterator(g, dt):
    y = dt
    for t in g:
        y += dt * t
    return y


REFUSED = [
    (number_on_the_left, V, "an operator with an object on its right, and on its left what may be a number or an array "
     "of NumPy's, which would not ask its class"),
    (as_an_array, Gone(0.3, 0.4), "a named tuple of class Gone is used as a whole, whose class defines '__iter__'"),
    (greatest, V, "a named tuple of class Vec is used as a whole, whose class defines '__len__'"),
    (in_their_order, V, "a named tuple of class Vec is ordered, whose class defines '__lt__'"),
    (chained, V, "a chain of comparisons of structures"),
    (unpacked_fields, grid(), "an object of class Grid is gone through, which has no __iter__"),
    (unpacked_fields, Plain(0.5), "an object of class Plain is gone through, which has no __iter__"),
    (its_own_iterator, Clock(1.0), "an object of class Clock says itself what comes next, by __next__"),
    (length_of_fields, Plain(0.5), "len() of an object of class Plain, whose class has no __len__"),
    (no_method, Given(0.3, 0.4), "no derivative rule for math.hypot with 1 arguments"),
]


@pytest.mark.parametrize("engine", ["numpy", "loops"])
@pytest.mark.parametrize(("kernel", "given"), [
    (unpacked, Gone(0.3, 0.4)), (looped, Gone(0.3, 0.4)), (truth, V), (as_a_bool, V), (turned, V), (in_an_arm, V),
    (unequal, Equal(0.5)), (unequal, Equal(-0.5)), (not_equal, Both(0.5)), (right_first, Outer(0.5)),
    (as_fields, Same(0.5, 1.0))], ids=lambda p: getattr(p, "__name__", ""))
def test_what_a_class_says_of_itself(kernel, given, engine):
    with running(engine) as name:
        value, gradient = s2sad.value_and_gradient(s2sad.differentiate(kernel, engine=name), wrt="dt")(given, 0.5)
    assert value == pytest.approx(kernel(given, 0.5), rel=1e-14)
    assert gradient == pytest.approx((kernel(given, 0.5 + 1e-5) - kernel(given, 0.5 - 1e-5)) / 2e-5, rel=1e-8)


@pytest.mark.parametrize(("kernel", "given", "message"), REFUSED, ids=[k.__name__ for k, _, _ in REFUSED])
def test_what_a_class_says_and_no_call_can_give(kernel, given, message):
    with pytest.raises(S2sadError) as caught:
        s2sad.gradient(kernel, wrt="dt")(given, 0.5)
    assert caught.value.diagnostics[0].message == message
    assert caught.value.diagnostics[0].span is not None
