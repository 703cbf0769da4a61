"""Guards: what was taken from outside while a program was read, compared at each later call.

    taken(function, "global", "G")     the value now; recorded, if anything is recording

A reading takes every value of its surroundings through `taken`: globals, closure cells, defaults, what modules,
objects, classes and dictionaries hold at any depth, the items of lists, the code of functions. What is recorded is what
the reading got, so that a value that is set meanwhile is seen at the next call. A reading that takes a place twice gets
one value. Containers are held, so a change anywhere on the way to a value is a change of one place: access paths need
not be followed again.
"""
from __future__ import annotations

import builtins
import dataclasses
import math
import operator
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import partial
from types import FunctionType, ModuleType
from typing import Any, TypeVar

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError

T = TypeVar("T")
ABSENT: Any = type("Absent", (), {"__repr__": lambda self: "ABSENT"})()
_WIDE = 2 ** 15                         # a product of four smaller numbers fits 64 bits
Getter = Callable[[Any, Any], Any]      # (key, default), as a mapping's `get`


def _cells(function: FunctionType) -> Getter:
    cells = dict(zip(function.__code__.co_freevars, function.__closure__ or ()))

    def get(name: str, default: Any) -> Any:
        try:
            return cells[name].cell_contents
        except (KeyError, ValueError):      # no such cell, or not bound yet
            return default
    return get


def _keywords(function: FunctionType) -> Getter:
    """The defaults of keyword-only parameters, whose dictionary may be replaced."""
    def get(name: str, default: Any) -> Any:
        return (function.__kwdefaults__ or {}).get(name, default)
    return get


def _annotations(function: FunctionType) -> Getter:
    """The words for the types of parameters, whatever objects stand there."""
    def get(name: str, default: Any) -> Any:
        found = function.__annotations__.get(name, ABSENT)
        return default if found is ABSENT else found.__name__ if isinstance(found, type) else str(found)
    return get


def _field(made: Any) -> Getter:
    """What a dataclass has for a field: its default, what makes it, whether it is given, by name, and compared."""
    def get(name: str, default: Any) -> Any:
        found = made.__dataclass_fields__.get(name)
        return default if found is None else (found.default, found.default_factory, found.init, found.kw_only is True,
                                              found.compare)
    return get


def _own(holder: Any) -> Getter:
    """What a module, class or object holds itself; an object's dictionary may be replaced."""
    if isinstance(holder, (type, ModuleType)):
        return vars(holder).get
    return lambda name, default: getattr(holder, "__dict__", {}).get(name, default)


# what a step from a holder to a value is called, and how it is made: each gives a `get`
STEPS: dict[str, Callable[[Any], Getter]] = {
    "global": lambda function: function.__globals__.get,
    "builtin": lambda _: vars(builtins).get,
    "module": lambda _: sys.modules.get,
    "cell": _cells,
    "code": lambda function: lambda *_: function.__code__,
    "keyword": _keywords,
    "annotation": _annotations,
    "fields": lambda made: lambda *_: tuple(d.name for d in dataclasses.fields(made)),
    "field": _field,
    "members": lambda made: lambda *_: tuple(made.__members__.values()),
    "combined": lambda made: lambda key, _: made(key),
    "own": _own,
    "attribute": lambda holder: partial(getattr, holder),
    "part": lambda holder: partial(getattr, holder),       # of what is never set anew, as of a method
    "class": lambda holder: lambda *_: type(holder),
    "mro": lambda made: lambda *_: made.__mro__,
    "item": lambda mapping: partial(dict.get, mapping),
    "keys": lambda mapping: lambda *_: tuple(mapping),
    "items": lambda sequence: lambda *_: frozen(sequence),
}


Path = tuple[Any, ...]                  # ((..., step, key), step, key): the way from what was read to a place


@dataclass(frozen=True)
class Guard:
    """A place, the value that was taken from it, and the way there."""
    holder: Any
    step: str
    key: Any
    value: Any
    path: Path


@dataclass(frozen=True)
class VaryingNumber:
    """A number that changes: not its value was taken, but its type; `now()` gives the value of a call."""
    get: Getter
    key: Any
    value: int | float

    def current_value(self) -> int | float:
        """The number now; raises S2sadError if it has become another kind of thing since the guards held."""
        found = self.get(self.key, ABSENT)
        if kind(found) is not type(self.value):
            raise S2sadError(Diagnostic("S405", f"'{self.key}', which the function reads from outside, became "
                                        f"{found!r} while its derivative was called", help="set it before the call"))
        return found


def kind(value: Any) -> type | None:
    """The type of a number that may become an argument when it changes, one of Python's own; None of all else. An
    integer that is negative or wide stays a constant: as such it is a step backwards, and is computed with exactly.

    >>> kind(0.5), kind(3), kind(-1), kind(2 ** 40), kind(True)
    (<class 'float'>, <class 'int'>, None, None, None)
    """
    return type(value) if type(value) is float or type(value) is int and 0 <= value < _WIDE else None


def current(value: Any) -> Any:
    """A value that was taken, as it is now: an array is what it is, a number that varies has another value."""
    return value.current_value() if isinstance(value, VaryingNumber) else value


class Guards:
    """The places that one reading took values from, in order. `hold()`: whether all of them are what they were:
    numbers, strings and sequences of them by value, everything else by identity, of arrays dtype and rank as well. Of
    the numbers at the paths in `varying` only the type counts."""

    def __init__(self, varying: Collection[Path] = ()) -> None:
        self.places: dict[tuple[int, str, Any], Guard] = {}
        self.varying = varying
        self._paths: dict[int, Path] = {id(None): ()}
        self._compared: list[tuple[Getter, Any, Any]] = []

    def take(self, holder: Any, step: str, key: Any) -> Any:
        place = (id(holder), step, key)
        known = self.places.get(place)
        if known is None:
            get = STEPS[step](holder)
            value, path = get(key, ABSENT), (self._paths.get(id(holder), (id(holder),)), step, key)
            if kind(value) is not None and path in self.varying:
                self._compared.append((lambda key, default: kind(get(key, default)), key, type(value)))
                value = VaryingNumber(get, key, value)
            else:
                self._compared.append((get, key, value))
            if isinstance(value, np.ndarray):
                self._compared.append((layout, value, layout(value)))
            known = self.places[place] = Guard(holder, step, key, value, path)
            self._paths.setdefault(id(value), path)
        return known.value

    def reach(self, holder: Any, step: str, key: Any, value: Any) -> Any:
        """Notes the way to a value that follows from what was taken before; the one that was noted first."""
        place = (id(holder), step, key)
        if place not in self.places:
            path = (self._paths.get(id(holder), (id(holder),)), step, key)
            self.places[place] = Guard(holder, step, key, value, path)
            self._paths.setdefault(id(value), path)
        return self.places[place].value

    def changed_numbers(self, before: Guards) -> list[Path]:
        """The paths at which both took numbers of one type that are not the same."""
        numbers = {g.path: g.value for g in before.places.values() if kind(g.value)}
        return [g.path for g in self.places.values() if g.path in numbers
                and kind(g.value) is kind(numbers[g.path]) and not same(g.value, numbers[g.path])]

    def hold(self) -> bool:
        for get, key, value in self._compared:
            now = get(key, ABSENT)
            if now is not value and not same(now, value):
                return False
        return True


def layout(array: np.ndarray, _: Any = None) -> tuple[Any, ...]:
    """What of an array is compiled in: its shape and dtype may change in place."""
    return array.dtype, *(n == 1 for n in array.shape)


_RECORDING: ContextVar[Guards | None] = ContextVar("s2sad_guards", default=None)


@contextmanager
def recording(guards: Guards) -> Iterator[Guards]:
    """All that is taken inside is recorded."""
    token = _RECORDING.set(guards)
    try:
        yield guards
    finally:
        _RECORDING.reset(token)


def taken(holder: Any, step: str, key: Any = "") -> Any:
    """The value at a place now, ABSENT if there is none; recorded, if anything is recording.

    >>> with recording(Guards()) as guards:
    ...     holder = {"dt": 0.1}
    ...     taken(holder, "item", "dt"), taken(holder, "item", "n")
    (0.1, ABSENT)
    >>> guards.hold(), holder.update(n=3), guards.hold()
    (True, None, False)
    """
    guards = _RECORDING.get()
    return STEPS[step](holder)(key, ABSENT) if guards is None else guards.take(holder, step, key)


def reached(holder: Any, step: str, key: Any, value: T) -> T:
    """The value, or what was noted in its place before; the way to it is noted. It follows from what was taken before,
    and needs no comparison."""
    guards = _RECORDING.get()
    return value if guards is None else guards.reach(holder, step, key, value)


def class_attribute(made: type, name: str) -> Any:
    """What a class has under a name, itself or from a base; ABSENT if none that is written in Python has it."""
    found = (taken(c, "own", name) for c in taken(made, "mro") if c is not object)
    return next((value for value in found if value is not ABSENT), ABSENT)


def frozen(value: Any) -> Any:
    """The items of nested lists, as tuples."""
    return tuple(map(frozen, value)) if isinstance(value, (list, tuple)) else value


def same(a: Any, b: Any) -> bool:
    """Whether two values are one object, or the same constant: of the same type, NaN and the sign of zero included.

    >>> same(0.0, -0.0), same(1, 1.0), same(math.nan, -math.nan), same((1.0, "a"), (1.0, "a"))
    (False, False, True, True)
    """
    if a is b:
        return True
    if type(a) is not type(b):
        return False
    if isinstance(a, (float, np.floating)):
        return bool(a == b) and math.copysign(1.0, a) == math.copysign(1.0, b) or bool(a != a and b != b)
    if isinstance(a, (complex, np.complexfloating)):
        return same(a.real, b.real) and same(a.imag, b.imag)
    if type(a) is tuple:
        return len(a) == len(b) and (all(map(operator.is_, a, b)) or all(map(same, a, b)))
    return isinstance(a, (bool, int, str, np.generic)) and bool(a == b)
