"""What a kernel reads from outside has changed since a process kept its derivative, no text has."""
from __future__ import annotations

import pytest

import s2sad

HELPERS = '''
import enum
import functools
import os
from collections import namedtuple
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

import s2sad

V = float(os.environ["VALUE_OF_THE_TEST"])
LATER = V > 2.0
LIST, NESTED, TABLE = [V, 1.0], [[V], [1.0]], {"a": V}
SET, HELD = frozenset((V, 1.0)), {"k": (frozenset((V,)), 2.0)}


class Mode(enum.Enum):
    A = V
    B = 7.0
    C = (V, 1.0)

    @property
    def twice(self):
        return 2.0 * self.value

    def of(self, x):
        return self.value * x


class Grown(enum.Enum):
    A = 1.0
    if LATER:
        B = 2.0


class Made(enum.Enum):
    A = 1

    def __init__(self, _):
        self.k = V


class Flags(enum.Flag):
    R = 1
    W = 8 if LATER else 2


CHOSEN, BOTH = Mode.A if LATER else Mode.B, Flags.R | Flags.W
MEMBERS = frozenset((Mode.A,) if LATER else (Mode.B,))


class Named(NamedTuple):
    a: float
    b: float = V
    c: tuple = (V, 1.0)


Old = namedtuple("Old", "a b", defaults=[V])


@dataclass(eq=LATER)
class Equal:
    a: float = 1.0


@dataclass
class Factory:
    a: float
    w: list = field(default_factory=lambda: [V])
    b: float = field(default=V, kw_only=True)


def closure(k):
    def scaled(x):
        return k * x
    return scaled


def factory(k):
    class Local:
        def of(self, x):
            return k * x
    return Local


def plain(x, k):
    return k * x


ONE, TWO = SimpleNamespace(k=1.5), SimpleNamespace(k=2.5)
FIRST, SECOND = [1.5], [2.5]
ROW, COLUMN = np.array([1.5, 1.0]), np.array([2.5, 1.0])
SLOW, FAST = closure(1.5), closure(2.5)
CLASS, OTHER = factory(1.5), factory(2.5)
PART, PARTS = functools.partial(plain, k=1.5), [functools.partial(plain, V)]
DERIVATIVE = s2sad.gradient(plain, wrt="x" if LATER else "k")
PICKED = {"object": TWO if LATER else ONE, "list": SECOND if LATER else FIRST}
ARRAY, FUNCTION, PAIR = COLUMN if LATER else ROW, FAST if LATER else SLOW, (ONE, TWO if LATER else ONE)
KIND, MIXED = OTHER if LATER else CLASS, [TWO, ONE] if LATER else [ONE, TWO]


def with_list(x, k=LIST):
    return k[0] * x


class Methods:
    @staticmethod
    def of(x, k=TABLE):
        return k["a"] * x
'''
KERNEL = '''
import numpy as np
from helpers_of_artifacts import *
from helpers_of_artifacts import V


def f({arguments}):
    return {value}
'''
# a kernel by what it reads, with its slopes before and after
READ = {
    "a list that is a default": ("x, k=LIST", "k[0] * x", 1.5, 2.5),
    "one by keyword": ("x, *, k=LIST", "k[0] * x", 1.5, 2.5),
    "nested lists": ("x, k=NESTED", "k[0][0] * x", 1.5, 2.5),
    "a dictionary": ("x, k=TABLE", "k['a'] * x", 1.5, 2.5),
    "a list in a tuple": ("x, k=(LIST, 2.0)", "k[0][0] * x", 1.5, 2.5),
    "a number in a list": ("x, k=[1.0, V]", "k[1] * x", 1.5, 2.5),
    "a class that is a default": ("x, k=Named", "k(x).b * x", 1.5, 2.5),
    "a helper's default": ("x", "with_list(x)", 1.5, 2.5),
    "a static method's default": ("x", "Methods.of(x) + (lambda v, k=LIST: k[0] * v)(x)", 3.0, 5.0),
    "a frozenset": ("x", "sum(SET) * x + sum(HELD['k'][0]) * x", 4.0, 6.0),
    "a member's value": ("x", "Mode.A.value * x", 1.5, 2.5),
    "a member by its name": ("x", "Mode['A'].value * x", 1.5, 2.5),
    "a value of a member's tuple": ("x", "Mode.C.value[0] * x", 1.5, 2.5),
    "all members": ("x", "len(Grown) * x + sum(m.value for m in Grown) * x", 2.0, 5.0),
    "a member by its value": ("x", "x * x if Mode(7.0) is CHOSEN else x", 2.0, 1.0),
    "an attribute of a member": ("x", "Made.A.k * x", 1.5, 2.5),
    "a property of a member": ("x", "Mode.A.twice * x", 3.0, 5.0),
    "a method of a member": ("x", "Mode.A.of(x)", 1.5, 2.5),
    "which member it is": ("x", "x * x if CHOSEN is Mode.A else x", 1.0, 2.0),
    "members in a set": ("x", "x * x if Mode.A in MEMBERS else x", 1.0, 2.0),
    "flags": ("x", "BOTH.value * x + (Flags.R | Flags.W).value * x + (~Flags.R).value * x", 8.0, 26.0),
    "a named tuple's defaults": ("x", "Named(1.0).b * x + Named(1.0).c[0] * x + Old(1.0).b * x", 4.5, 7.5),
    "how objects are equal": ("x", "x * x if Equal() == Equal() else x", 1.0, 2.0),
    "a field by keyword": ("x", "Factory(1.0).b * x + Factory(1.0).w[0] * x", 3.0, 5.0),
    "a partial in a list": ("x", "PARTS[0](x)", 1.5, 2.5),
    "which derivative": ("x", "DERIVATIVE(x, 3.0) + 0.0 * plain(x, 1.0)", 1.0, 0.0),
    "which object": ("x", "0.0 * (ONE.k + TWO.k) * x + PICKED['object'].k * x", 1.5, 2.5),
    "which object of a tuple": ("x", "0.0 * (ONE.k + TWO.k) * x + PAIR[1].k * x", 1.5, 2.5),
    "the order of objects": ("x", "0.0 * (ONE.k + TWO.k) * x + MIXED[0].k * x", 1.5, 2.5),
    "an object that is a default": ("x, k=PAIR", "0.0 * (ONE.k + TWO.k) * x + k[1].k * x", 1.5, 2.5),
    "which list": ("x", "0.0 * (FIRST[0] + SECOND[0]) * x + PICKED['list'][0] * x", 1.5, 2.5),
    "which array": ("x", "0.0 * (ROW[0] + COLUMN[0]) * x + ARRAY[0] * x", 1.5, 2.5),
    "which closure": ("x", "0.0 * (SLOW(x) + FAST(x)) + FUNCTION(x)", 1.5, 2.5),
    "which class": ("x", "0.0 * (CLASS().of(x) + OTHER().of(x)) + KIND().of(x)", 1.5, 2.5),
}


def slope(f, x=1.0):
    return s2sad.gradient(s2sad.differentiate(f, engine="numpy"), wrt="x")(x)


@pytest.mark.parametrize("title", READ)
def test_what_has_changed_is_derived_anew(title, processes, monkeypatch):
    arguments, value, before, after = READ[title]
    processes.write(KERNEL.format(arguments=arguments, value=value), HELPERS)
    for number, right in (("1.5", before), ("2.5", after)) * 2:
        monkeypatch.setenv("VALUE_OF_THE_TEST", number)
        assert slope(processes.fresh().f) == right
    assert not processes.derived        # both are kept


def test_a_default_that_is_changed_after_it_was_loaded(processes, monkeypatch):
    monkeypatch.setenv("VALUE_OF_THE_TEST", "1.5")
    processes.write(KERNEL.format(arguments="x, k=LIST, *, t=TABLE", value="k[0] * x + t['a'] * x * len(k)"), HELPERS)
    for _ in range(2):
        module = processes.fresh()
        assert slope(module.f) == 4.5
    assert processes.warm
    module.LIST[0] = 4.0
    assert slope(module.f) == 7.0
    module.LIST.append(1.0)
    module.TABLE["a"] = 2.0
    assert slope(module.f) == 10.0


def test_a_type_that_an_annotation_names(processes, monkeypatch):
    """With what is differentiated by default."""
    kernel = KERNEL.format(arguments="x, n: int if LATER else float = 2", value="[x * n, x][0]")
    processes.write(kernel.replace("import V", "import V, LATER"), HELPERS)
    for number, right in (("1.5", {"x": 2.0, "n": 1.0}), ("2.5", 2.0)) * 2:
        monkeypatch.setenv("VALUE_OF_THE_TEST", number)
        assert s2sad.gradient(s2sad.differentiate(processes.fresh().f, engine="numpy"))(1.0, 2) == right


def test_a_default_that_is_replaced_after_it_was_loaded(processes, monkeypatch):
    monkeypatch.setenv("VALUE_OF_THE_TEST", "1.5")
    processes.write(KERNEL.format(arguments="x, k=LIST", value="k[0] * x * Named(1.0).b"), HELPERS)
    for _ in range(2):
        module = processes.fresh()
        assert slope(module.f) == 2.25
    assert processes.warm
    module.f.__defaults__ = ([4.0],)
    assert slope(module.f) == 6.0
    module.Named.__new__.__defaults__ = (3.0, ())
    assert slope(module.f) == 12.0
