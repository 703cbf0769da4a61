"""What a name from outside a kernel can mean, whether it was looked up in a live function or in a file's text."""
from __future__ import annotations

import builtins
import math
import sys
import types
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy

from s2sad.diagnostics import Source
from s2sad.rules.spellings import is_scipy
from s2sad.structure import record_fields
from s2sad.tree import AST, FunctionDef

BUILTIN_CALLS = ("abs", "bool", "enumerate", "float", "int", "len", "max", "min", "pow", "print", "range", "reversed",
                 "round", "slice", "sum", "zip")
_NUMBERS = ("pi", "e", "tau", "inf", "nan")


@dataclass(frozen=True)
class Library:
    """Something of a library, by its dotted path: a function, a type, a constant."""
    path: str


@dataclass(frozen=True)
class Number:
    """A number of a module or closure; `current` looks it up again."""
    name: str
    value: Any
    current: Callable[[], Any] | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Array:
    """An array of a module or closure; `current` looks it up again."""
    name: str
    value: Any
    current: Callable[[], Any] | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Record:
    """A class that only holds fields: a dataclass or a named tuple."""
    name: str
    value: type
    current: Callable[[], Any] | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Text:
    value: str


@dataclass(frozen=True)
class Function:
    """A function of the user's: `handle` is what `capture` takes, `key` tells one from another; `given` are keywords
    that every call of it gives, with the names of what it gives."""
    name: str
    key: Hashable
    path: str
    handle: Any = field(compare=False)
    given: tuple[tuple[str, str], ...] = field(default=(), compare=False)


@dataclass(frozen=True)
class Unusable:
    """A known name that a kernel cannot use: what it is, and what to do."""
    what: str
    help: str


_WRITTEN_OUT = 64   # items of a sequence from outside: more are an array's


class Scope(Protocol):
    """The names around a kernel, or those of a module."""

    def lookup(self, name: str) -> Meaning | None: ...

    def known(self) -> list[str]: ...


@dataclass(frozen=True)
class Space:
    """A module: its names are reached as attributes."""
    name: str
    scope: Scope = field(compare=False)


@dataclass(frozen=True)
class Numbers:
    """A tuple or list of numbers, or of such tuples, that the kernel reads from outside."""
    items: tuple[Number | Numbers, ...]


@dataclass(frozen=True)
class Table:
    """A dict of the module's, or a class that holds constants: what stands under each key or name."""
    what: str
    items: dict[str, Meaning] = field(compare=False)


Meaning = Library | Number | Numbers | Table | Array | Record | Text | Function | Unusable | Space


@dataclass(frozen=True)
class Captured:
    """A function's definition with its surroundings; `defaults` are the evaluated ones of a live function."""
    name: str
    tree: FunctionDef
    source: Source
    scope: Scope
    default: Callable[[str, AST], Any]


class NotConstant(Exception):
    """A default or a module's value that is not a plain constant."""


class LibraryScope:
    """The names of numpy and math, checked to exist; of other libraries every name is taken for there."""

    def __init__(self, path: str):
        self.path = path

    def lookup(self, name: str) -> Meaning | None:
        path = f"{self.path}.{name}"
        if self.path.startswith("numba") and name == "prange":
            return Library("builtins.range")
        if self.path == "s2sad.runtime":
            return Library(f"runtime.{name}")
        if path.partition(".")[0] not in ("numpy", "math"):
            return Space(path, LibraryScope(path))
        owner = library_value(self.path)
        if not hasattr(owner, name):
            return None
        if isinstance(getattr(owner, name), types.ModuleType):
            return Space(path, LibraryScope(path))
        return Library(path)

    def known(self) -> list[str]:
        root = self.path.partition(".")[0]
        return [n for n in dir(library_value(self.path)) if n[0] != "_"] if root in ("numpy", "math") else []


def library_value(path: str) -> Any:
    """The object at a dotted path of numpy, math or builtins; None if there is none."""
    root, *rest = path.split(".")
    value: Any = {"numpy": numpy, "math": math, "builtins": builtins}.get(root)
    for part in rest:
        value = getattr(value, part, None)
    return value


def library_path(name: str, value: Any) -> str | None:
    """The dotted path of a value that numpy, math or builtins define, called `name` by the user."""
    if type(value) is float:
        # `from math import pi` binds the library's own object; the same number written out is another object
        paths = (f"{m.__name__}.{n}" for m in (math, numpy) for n in _NUMBERS if getattr(m, n, None) is value)
        return next(paths, None)
    if not callable(value):
        return None
    own = getattr(value, "__name__", "")
    for module in (builtins, math, numpy, numpy.linalg):
        for candidate in (name, own):
            if candidate and getattr(module, candidate, None) is value:
                return f"{module.__name__}.{candidate}"
    home = str(getattr(value, "__module__", ""))
    if home.startswith("scipy.") and getattr(sys.modules.get("scipy.linalg"), own, None) is value and is_scipy(
            f"scipy.linalg.{own}"):
        return f"scipy.linalg.{own}"
    if home.partition(".")[0] == "numpy" and getattr(library_value(home), own, None) is value:
        return f"{home}.{own}"
    return None


def dotted(meaning: Meaning | None) -> str | None:
    """The path of something of a library; None for anything else."""
    return meaning.path if isinstance(meaning, Library) else meaning.name if isinstance(meaning, Space) else None


def is_number(value: Any) -> bool:
    return isinstance(value, (bool, int, float, numpy.bool_, numpy.integer, numpy.floating))


def _table(what: str, name: str, held: dict[str, Any], current: Callable[[], Any] | None,
           get: Callable[[Any, str], Any]) -> Table:
    def item(k: str) -> Callable[[], Any] | None:
        def now() -> Any:
            return None if current is None else get(current(), k)
        return None if current is None else now
    return Table(what, {k: value_meaning(f"{name}_{k}", v, item(k)) for k, v in held.items()})


def is_numbers(value: Any, kinds: type | tuple[type, ...] = (tuple, list)) -> bool:
    """Whether a value is a tuple (or a list) of numbers, or of such."""
    return isinstance(value, kinds) and len(value) > 0 and all(is_number(v) or is_numbers(v, kinds) for v in value)


def _count(value: Any) -> int:
    return sum(map(_count, value)) if isinstance(value, (tuple, list)) else 1


def _numbers(name: str, value: Any, current: Callable[[], Any] | None) -> Numbers:
    """The items of a sequence, each a number of its own; where the sequence has another length now, they are none."""
    def item(k: int) -> Callable[[], Any] | None:
        def now() -> Any:
            whole = current() if current is not None else None
            return whole[k] if isinstance(whole, (tuple, list)) and len(whole) == len(value) else None
        return None if current is None else now
    return Numbers(tuple(_numbers(f"{name}_{k}", v, item(k)) if isinstance(v, (tuple, list)) else
                         Number(f"{name}_{k}", v, item(k)) for k, v in enumerate(value)))


def kind_of(value: Any) -> str:
    """A value's type as one says it: `a list`, `an object`."""
    word = type(value).__name__
    return f"{'an' if word[0].lower() in 'aeiou' else 'a'} {word}"


def value_meaning(name: str, value: Any, current: Callable[[], Any] | None = None) -> Meaning:
    """What a number, string, array or other plain value means."""
    if is_number(value):
        return Number(name, value, current)
    if isinstance(value, numpy.ndarray) and value.dtype.kind in "biuf":
        return Array(name, value, current)
    if isinstance(value, str):
        return Text(value)
    if is_numbers(value) and _count(value) <= _WRITTEN_OUT:
        return _numbers(name, value, current)
    if isinstance(value, dict) and value and all(isinstance(k, str) for k in value):
        return _table("a dict", name, value, current, lambda holder, k: holder.get(k))
    if isinstance(value, (complex, numpy.complexfloating)):
        return Unusable("a complex number", "keep the real and the imaginary part as two numbers")
    if isinstance(value, numpy.ndarray):
        return Unusable(f"an array of {value.dtype}", "use an array of floats, integers or bools")
    if isinstance(value, type) and record_fields(value) is not None:
        return Record(name, value, current)
    if isinstance(value, type) and any(is_number(v) for v in vars(value).values()):
        held = {k: v for k, v in vars(value).items() if not k.startswith("_")}
        return _table("a class", name, held, current, lambda holder, k: getattr(holder, k, None))
    if isinstance(value, type):
        return Unusable("a class", "pass its fields as arguments of the kernel, numbers and arrays")
    return Unusable(kind_of(value), "pass it as an argument, or make it a number or a NumPy array")
