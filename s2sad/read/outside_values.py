"""What a name from outside a kernel can mean, whether it was looked up in a live function or in a file's text."""
from __future__ import annotations

import builtins
import math
import sys
import types
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy

from s2sad.infer.bounded_arithmetic import BITS, is_bounded
from s2sad.diagnostics import Source
from s2sad.live_objects.guards import taken
from s2sad.rules.spellings import is_scipy
from s2sad.pytree import SPARSE, record_fields, sparse_format
from s2sad.tree import AST, FunctionDef

BUILTIN_CALLS = ("abs", "all", "any", "bool", "complex", "divmod", "enumerate", "float", "int", "isinstance", "len",
                 "max", "min", "pow", "print", "range", "reversed", "round", "slice", "sum", "zip")
_NUMBERS = ("pi", "e", "tau", "inf", "nan")


@dataclass(frozen=True)
class Library:
    """Something of a library, by its dotted path: a function, a type, a constant."""
    path: str


@dataclass(frozen=True)
class Number:
    """A number of a module or closure."""
    name: str
    value: Any


@dataclass(frozen=True)
class Array:
    """An array of a module or closure."""
    name: str
    value: Any


@dataclass(frozen=True)
class NumberTable(Array):
    """A tuple or list of numbers, nested or not, as an array: that is what it is where a variable picks its numbers;
    `numbers` are these, written out, where they are few, `columns` an array for each column of rows."""
    what: str = ""
    numbers: Numbers | None = None
    columns: tuple[Array, ...] = ()

    @property
    def mixed(self) -> bool:
        """Whether its rows hold numbers of several kinds: integers that one array would make floats."""
        return len({c.value.dtype for c in self.columns}) > 1


@dataclass(frozen=True)
class Record:
    """A class that only holds fields: a dataclass or a named tuple."""
    name: str
    value: type


@dataclass(frozen=True)
class Matrix:
    """A sparse matrix of a module or closure."""
    name: str
    value: Any

    def parts(self) -> tuple[list[Array], list[Number]]:
        """The arrays that it is made of, and its shape."""
        kinds = SPARSE[taken(self.value, "attribute", "format")]
        return ([Array(f"{self.name}_{k}", taken(self.value, "attribute", k)) for k in kinds[:-1]],
                [Number(f"{self.name}_{w}", int(n)) for w, n in zip(
                    ("rows", "columns"), taken(self.value, "attribute", "shape"))])


@dataclass(frozen=True)
class StringValue:
    value: str


@dataclass(frozen=True)
class UserFunctionValue:
    """A function of the user's: `handle` is what `capture` takes, `key` tells one from another."""
    name: str
    key: Hashable
    path: str
    handle: Any = field(compare=False)


@dataclass(frozen=True)
class Unusable:
    """A known name that a kernel cannot use: what it is, and what to do."""
    what: str
    help: str


_SCALARS = (numpy.int32, numpy.int64, numpy.longlong, numpy.float32, numpy.float64)
_WRITTEN_OUT = 64   # items of a sequence from outside: more are an array's


class OutsideScope(Protocol):
    """The names of a module."""

    def lookup(self, name: str) -> Meaning | None: ...

    def known(self) -> list[str]: ...


class Surroundings(OutsideScope, Protocol):
    """The names around a kernel, and what it imports itself."""

    def imported(self, module: str, level: int, name: str | None) -> Meaning: ...


@dataclass(frozen=True)
class ModuleValue:
    """A module: its names are reached as attributes."""
    name: str
    scope: OutsideScope = field(compare=False)


@dataclass(frozen=True)
class Namespace(ModuleValue):
    """A dictionary, an object or a class: what it holds is reached as items or attributes."""
    what: str = ""


@dataclass(frozen=True)
class Numbers:
    """A tuple or list of numbers, or of such tuples, that the kernel reads from outside: written out."""
    items: tuple[Number | Numbers, ...]


Meaning = (Library | Number | Numbers | Array | Record | Matrix | StringValue | UserFunctionValue | Unusable
           | ModuleValue)


@dataclass(frozen=True)
class Captured:
    """A function's definition with its surroundings; `default` gives the values of defaults, `renamed` what the user
    calls variables of inner scopes that were given names of their own, `unsure` the names that may be read before they
    are bound, if that is known."""
    name: str
    tree: FunctionDef
    source: Source
    scope: Surroundings
    default: Callable[[str, AST], Any]
    renamed: Mapping[str, str] = field(default_factory=dict, compare=False)
    unsure: frozenset[str] | None = field(default=None, compare=False)


class NotConstant(Exception):
    """A default or a module's value that is not a plain constant; with what it means, where that is known."""


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
            return ModuleValue(path, LibraryScope(path))
        owner = library_value(self.path)
        if not hasattr(owner, name):
            return None
        if isinstance(getattr(owner, name), types.ModuleType):
            return ModuleValue(path, LibraryScope(path))
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
    rooms = ("scipy.linalg", "scipy.fft", "scipy.sparse", "scipy.sparse.linalg", "scipy.special")
    for room in rooms if home.startswith("scipy.") else ():
        if getattr(sys.modules.get(room), own, None) is value and is_scipy(f"{room}.{own}"):
            return f"{room}.{own}"
    if home in ("itertools", "cmath") and getattr(sys.modules.get(home), own, None) is value:
        return f"{home}.{own}"
    if home.partition(".")[0] == "numpy" and getattr(library_value(home), own, None) is value:
        return f"{home}.{own}"
    return None


def dotted(meaning: Meaning | None) -> str | None:
    """The path of something of a library; None for anything else."""
    if isinstance(meaning, Library):
        return meaning.path
    return meaning.name if isinstance(meaning, ModuleValue) and not isinstance(meaning, Namespace) else None


_BINARY = ("add", "sub", "mul", "truediv", "floordiv", "mod", "divmod", "pow")
_UNARY = ("neg", "pos", "abs", "bool", "float", "int", "round", "trunc", "floor", "ceil")
_ARITHMETIC = [f"__{f}__" for f in (*_BINARY, *(f"r{f}" for f in _BINARY), *_UNARY, "eq", "ne", "lt", "le", "gt", "ge")]


def is_number(value: Any) -> bool:
    """Whether a value is computed with as Python's and NumPy's numbers of 64 bits are; a float32 counts as one."""
    kind = type(value)
    own = isinstance(value, (int, float)) and any(
        getattr(kind, f) not in (getattr(int, f), getattr(float, f)) for f in _ARITHMETIC)
    return kind in _SCALARS or isinstance(value, (int, float)) and not own or isinstance(
        value, complex) and bool(numpy.isfinite(value))


def _plain(value: Any) -> Any:
    """The number itself, of one that belongs to an enumeration or to another class of the user's."""
    if isinstance(value, int) and type(value) not in (int, bool):
        return int.__index__(value)
    return float.__float__(value) if isinstance(value, float) and type(value) not in (float, *_SCALARS) else value


def is_numbers(value: Any, kinds: type | tuple[type, ...] = (tuple, list)) -> bool:
    """Whether a value is a tuple (or a list) of numbers, or of such."""
    return isinstance(value, kinds) and len(value) > 0 and all(is_number(v) or is_numbers(v, kinds) for v in value)


def _count(value: Any) -> int:
    return sum(map(_count, value)) if isinstance(value, (tuple, list)) else 1


def _numbers(name: str, value: Any) -> Numbers:
    """The items of a sequence, each a number of its own."""
    items = [(f"{name}_{k}", v) for k, v in enumerate(value)]
    return Numbers(tuple(_numbers(n, v) if isinstance(v, (tuple, list)) else Number(n, _plain(v)) for n, v in items))


def kind_of(value: Any) -> str:
    """A value's type as one says it: `a list`, `an object`."""
    word = type(value).__name__
    return f"{'an' if word[0].lower() in 'aeiou' else 'a'} {word}"


def value_meaning(name: str, value: Any, items: Any = None) -> Meaning:
    """What a number, string, array or other plain value means; `items` are what a list or tuple held when it was
    taken."""
    if not is_bounded(value):
        return Unusable(f"an integer of more than {BITS} bits", "make it a float")
    if is_number(value):
        return Number(name, _plain(value))
    if isinstance(value, numpy.ndarray) and type(value) not in (numpy.ndarray, numpy.memmap):
        return Unusable(kind_of(value), "make it a plain array: np.array(...)")
    if isinstance(value, numpy.ndarray) and value.dtype.kind in "biufc" and value.dtype != numpy.complex64:
        return Array(name, value)
    if isinstance(value, str):
        return StringValue(str.__str__(value))     # of one of a class of the user's
    if isinstance(value, (complex, numpy.complexfloating)):
        return Unusable("a complex number that is not finite, or of 64 bits", "make it in the kernel")
    if isinstance(value, numpy.ndarray):
        return Unusable(f"an array of {value.dtype}", "use an array of floats, integers or bools")
    if sparse_format(value) is not None:
        return Matrix(name, value)
    if isinstance(value, type) and record_fields(value) is not None:
        return Record(name, value)
    if isinstance(value, type):
        return Unusable("a class", "pass its fields as arguments of the kernel, numbers and arrays")
    items = value if items is None else items
    if is_numbers(items):
        written = _numbers(name, items) if _count(items) <= _WRITTEN_OUT else None
        array = _as_array(items)
        found = written if array is None else NumberTable(name, array, kind_of(value), written, _columns(name, items,
                                                                                                         array))
        return found or Unusable(kind_of(value), "make it a NumPy array")
    return Unusable(kind_of(value), "pass it as an argument, or make it a number or a NumPy array")


def _columns(name: str, value: tuple | list, array: numpy.ndarray) -> tuple[Array, ...]:
    """The columns of rows of numbers, each of its own kind."""
    return tuple(Array(f"{name}_{k}", numpy.array(c)) for k, c in enumerate(zip(*value))) if array.ndim == 2 else ()


def _as_array(value: tuple | list) -> numpy.ndarray | None:
    """Numbers that a tuple or list holds, in a shape; None where there are none, or anything else among them."""
    try:
        found = numpy.array(value)
    except (ValueError, OverflowError):  # rows of different lengths
        return None
    return found if found.size and found.dtype.kind in "if" else None
