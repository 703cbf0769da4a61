"""What a kernel takes from outside is compared at each call, however deep it lies and however it was changed."""
from __future__ import annotations

import enum
import functools
import math
import sys
import types
from collections import namedtuple
from dataclasses import dataclass

import numpy as np
import pytest

import s2sad
from s2sad import read
from s2sad.run.compiled import available

THIS = sys.modules[__name__]

outer = types.ModuleType("outer")
outer.inner = types.ModuleType("inner")
outer.inner.rate = 2.0


class Base:
    order = 2.0

    def factor(self):
        return self.k * self.order


class Model(Base):
    def __init__(self):
        self.k, self.w, self.part = 2.0, np.array([1.0, 2.0]), Part(3.0)

    def energy(self, x):
        return self.factor() * self.part.scaled(x)

    def factor_of(self, x):
        return self.factor() * x

    def weighted(self, x):
        return np.sum(self.w) * x

    def __call__(self, x):
        return self.factor() * x


class Other(Model):
    order = 5.0


@dataclass
class Part:
    scale: float

    def scaled(self, x):
        return self.scale * x


class Colour(enum.IntEnum):
    RED = 2
    BLUE = 3


Pair = namedtuple("Pair", "a b")
MODEL, RATE, PAIR, LIST, COLOUR = Model(), 2.0, Pair(2.0, [3.0, 4.0]), [2.0, [3.0, 4.0]], Colour.RED
TABLE = {"a": 2.0, "inner": {"b": 3.0}, "model": MODEL}
PICKED = {"twice": lambda x: 2.0 * x,
          "thrice": lambda x: 3.0 * x}


def helper(x, c=2.0, *, d=3.0):
    return c * d * x


def of_the_object(x):
    return MODEL.energy(x) + MODEL(x)


def of_modules(x):
    return outer.inner.rate * RATE * x


def of_items(x):
    return TABLE["a"] * TABLE["inner"]["b"] * TABLE["model"].k * PAIR.a * x


def of_lists(x):
    return (LIST[0] + LIST[1][0] * PAIR.b[1]) * x


def of_an_enumeration(x):
    return COLOUR * x


def of_defaults(x):
    return helper(x)


def of_arrays(x):
    return MODEL.weighted(x)


def of_a_closure():
    k = 2.0

    def inner(x):
        return k * x

    def assign(value):
        nonlocal k
        k = value
    return inner, assign


def picked(x, name):
    return PICKED[name](x)


def keys(space, **values):
    return lambda monkeypatch: [monkeypatch.setitem(space, k, v) for k, v in values.items()]


def put(holder, name, value):
    return lambda monkeypatch: monkeypatch.setattr(holder, name, value)


def deleted(monkeypatch):
    monkeypatch.setattr(MODEL, "order", 7.0, raising=False)     # hides the class's
    assert s2sad.gradient(s2sad.differentiate(of_the_object, engine="numpy"))(1.0) == of_the_object(1.0)
    monkeypatch.delattr(MODEL, "order")


CHANGES = {
    "an attribute, read by a method of a method": (of_the_object, put(MODEL, "k", 5.0)),
    "an attribute of an object in an object": (of_the_object, lambda m: m.setattr(MODEL.part, "scale", 4.0)),
    "an object in an object": (of_the_object, put(MODEL, "part", Part(6.0))),
    "the dictionary of an object": (of_the_object, put(MODEL, "__dict__", {**vars(Model()), "k": 9.0})),
    "an attribute of a base": (of_the_object, put(Base, "order", 4.0)),
    "an attribute of the class that hides the base's": (
        of_the_object, lambda monkeypatch: monkeypatch.setattr(Model, "order", 6.0, raising=False)),
    "an attribute of the object that hides the class's": (
        of_the_object, lambda monkeypatch: monkeypatch.setattr(MODEL, "order", 7.0, raising=False)),
    "an attribute that is deleted": (of_the_object, deleted),
    "the class of an object": (of_the_object, put(MODEL, "__class__", Other)),
    "a method": (of_the_object, put(Base, "factor", lambda self: 11.0 * self.k)),
    "a method of the object's own": (of_the_object, put(Part, "scaled", lambda self, x: 13.0 * x)),
    "what calls an object": (of_the_object, put(Model, "__call__", lambda self, x: 17.0 * x)),
    "a module in a module": (of_modules, put(outer.inner, "rate", 5.0)),
    "a module that is another": (of_modules, put(outer, "inner", types.SimpleNamespace(rate=6.0))),
    "a number that is an integer": (of_modules, put(THIS, "RATE", 2)),
    "a number": (of_modules, put(THIS, "RATE", -0.0)),
    "an item": (of_items, keys(TABLE, a=4.0)),
    "an item of a dictionary in it": (of_items, keys(TABLE["inner"], b=5.0)),
    "a dictionary in it": (of_items, keys(TABLE, inner={"b": 7.0})),
    "an object in a dictionary": (of_items, put(MODEL, "k", 8.0)),
    "another object in a dictionary": (of_items, keys(TABLE, model=types.SimpleNamespace(k=9.0))),
    "a named tuple": (of_items, put(THIS, "PAIR", Pair(5.0, [3.0, 4.0]))),
    "a list in a named tuple": (of_lists, lambda m: PAIR.b.__setitem__(1, 6.0)),
    "a list in a list": (of_lists, lambda m: LIST[1].__setitem__(0, 8.0)),
    "a list": (of_lists, put(THIS, "LIST", [1.0, [2.0]])),
    "an enumeration": (of_an_enumeration, put(THIS, "COLOUR", Colour.BLUE)),
    "the defaults of a helper": (of_defaults, put(helper, "__defaults__", (4.0,))),
    "a default by keyword": (of_defaults, keys(helper.__kwdefaults__, d=5.0)),
    "all defaults by keyword": (of_defaults, put(helper, "__kwdefaults__", {"d": 7.0})),
    "the code of a helper": (of_defaults, put(helper, "__code__", (lambda x, c=2.0, *, d=3.0: c + d * x * 0.0 + x
                                                                   ).__code__)),
    "another helper": (of_defaults, put(THIS, "helper", lambda x: 19.0 * x)),
    "an array that is another": (of_arrays, put(MODEL, "w", np.array([3.0, 4.0]))),
    "an array that is written": (of_arrays, lambda m: MODEL.w.__setitem__(0, 7.0)),
    "an array of another type": (of_arrays, put(MODEL, "w", np.array([3, 4, 5]))),
}


@pytest.fixture(autouse=True)
def as_it_was():
    yield
    vars(MODEL).clear()
    MODEL.__init__()
    PAIR.b[:], LIST[1][:] = [3.0, 4.0], [3.0, 4.0]


def value_and_slope(f):
    """A kernel that is affine in x, its value and its slope."""
    return f(1.0), f(1.0) - f(0.0)


@pytest.mark.parametrize("title", CHANGES)
def test_changes_are_seen(title, monkeypatch):
    f, change = CHANGES[title]
    g = s2sad.value_and_gradient(s2sad.differentiate(f, engine="numpy"))
    assert g(1.0) == pytest.approx(value_and_slope(f))
    before = value_and_slope(f)
    change(monkeypatch)
    assert title == "an attribute that is deleted" or value_and_slope(f) != before or "integer" in title
    for again in (g, s2sad.value_and_gradient(s2sad.differentiate(f, engine="numpy"))):
        assert again(1.0) == pytest.approx(value_and_slope(f))
    monkeypatch.undo()
    as_it_was_before = value_and_slope(f)
    assert g(1.0) == pytest.approx(as_it_was_before)


@pytest.mark.skipif(not available(), reason="needs Numba")
@pytest.mark.parametrize("title", ["an attribute, read by a method of a method", "an array that is another",
                                   "an array that is written"])
def test_changes_are_seen_when_compiled(title, monkeypatch):
    f, change = CHANGES[title]
    g = s2sad.value_and_gradient(s2sad.differentiate(f, engine="numba"))
    assert g(1.0) == pytest.approx(value_and_slope(f))
    change(monkeypatch)
    assert g(1.0) == pytest.approx(value_and_slope(f))


def test_a_new_builtin_and_a_new_key(monkeypatch):
    g = s2sad.gradient(s2sad.differentiate(shortened, engine="numpy"))
    assert g(-2.0) == -1.0
    monkeypatch.setattr(THIS, "abs", lambda x: 3.0 * x, raising=False)
    assert g(-2.0) == 3.0
    g = s2sad.gradient(s2sad.differentiate(picked, engine="numpy"), wrt="x")
    assert g(1.0, "twice") == 2.0
    monkeypatch.setitem(PICKED, "five", lambda x: 5.0 * x)
    assert g(1.0, "five") == 5.0


def shortened(x):
    return abs(x)


def test_cells_are_compared():
    inner, assign = of_a_closure()
    g = s2sad.gradient(s2sad.differentiate(inner, engine="numpy"))
    assert g(1.0) == 2.0
    assign(3.0)
    assert g(1.0) == 3.0
    assign(math.nan)
    assert math.isnan(g(1.0))


def test_objects_methods_and_partials_as_kernels(monkeypatch):
    made = [s2sad.gradient(s2sad.differentiate(f, engine="numpy")) for f in (MODEL, MODEL.energy)]
    assert [g(1.0) for g in made] == [4.0, 12.0]
    monkeypatch.setattr(MODEL, "k", 3.0)
    assert [g(1.0) for g in made] == [6.0, 18.0]
    monkeypatch.setattr(Model, "__call__", lambda self, x: 5.0 * self.k * x)
    assert made[0](1.0) == 15.0 == MODEL(1.0)
    given = functools.partial(helper, d=4.0)
    g = s2sad.gradient(s2sad.differentiate(given, engine="numpy"), wrt="x")
    assert g(1.0) == 8.0


def applied(f, x):
    return f(x)


def test_functions_that_are_given_read_from_outside(monkeypatch):
    for given, change in ((MODEL.energy, put(MODEL, "k", 3.0)), (MODEL.factor_of, put(Base, "order", 7.0)),
                          (of_modules, put(outer.inner, "rate", 9.0))):
        g = s2sad.gradient(s2sad.differentiate(applied, engine="numpy"), wrt="x")
        assert g(given, 1.0) == given(1.0)
        change(monkeypatch)
        assert g(given, 1.0) == given(1.0)


def test_what_was_read_is_compared_and_not_what_was_there_before(monkeypatch):
    g, load = s2sad.gradient(s2sad.differentiate(of_modules, engine="numpy")), read.load

    def meanwhile(f, *rest):
        """Reads while another thread sets a constant, and sets it back."""
        monkeypatch.setattr(THIS, "RATE", 3.0)
        try:
            return load(f, *rest)
        finally:
            monkeypatch.setattr(THIS, "RATE", 4.0)

    monkeypatch.setattr(THIS, "RATE", 4.0)
    monkeypatch.setattr(read, "load", meanwhile)
    g(1.0)
    monkeypatch.setattr(read, "load", load)
    assert [g(1.0) for _ in range(2)] == [8.0, 8.0]


def test_values_that_were_taken_before_are_not_read_again(monkeypatch):
    """A constant that goes back and forth has a derivative for each value, and is read once for each."""
    readings = []
    monkeypatch.setattr(read, "load", lambda *given, load=read.load: readings.append(given) or load(*given))
    g = s2sad.gradient(s2sad.differentiate(of_modules, engine="numpy"))
    for rate in (31.0, 32.0) * 3:
        monkeypatch.setattr(THIS, "RATE", rate)
        assert g(1.0) == 2.0 * rate
    assert len(readings) == 2


@dataclass
class Doubled:
    a: float

    def __init__(self, a):
        self.a = 2.0 * a


def through_a_constructor(x):
    return Doubled(x).a


def test_a_dataclass_with_a_constructor_of_its_own_is_no_mere_record():
    assert s2sad.gradient(s2sad.differentiate(through_a_constructor, engine="numpy"))(1.0) == 2.0
