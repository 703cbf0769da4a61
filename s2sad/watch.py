"""What a function reads from outside itself, so that a derivative made for other values is never run.

Numba freezes globals, and so does a generated file; a constant that was changed since would give a stale gradient.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from s2sad.binding import same_number
from s2sad.read import holders
from s2sad.read.underlying import given, python_function
from s2sad.structure import sparse_format

_ABSENT = object()
_LIBRARIES = ("numpy", "math", "builtins", "numba", "scipy")


class Watch:
    """The globals and closure cells that a function and the functions it calls read, with their values now, and the
    code and defaults of these functions.

    Numbers are compared by value; arrays, functions and everything else by identity (an array's content is read at
    each call). `unchanged()` costs a dictionary look-up for each.
    """

    def __init__(self, function: FunctionType):
        self.functions: list[tuple[FunctionType, CodeType, Any]] = []
        self.places: list[tuple[Mapping[str, Any], str, Any]] = []
        self.cells: list[tuple[Any, Any]] = []
        self._seen: set[Any] = set()
        self._add(function)

    def unchanged(self) -> bool:
        for function, code, defaults in self.functions:
            if function.__code__ is not code or function.__defaults__ is not defaults:
                return False
        for space, name, value in self.places:
            now = space.get(name, _ABSENT)
            if now is not value and not same_number(now, value):
                return False
        for cell, value in self.cells:
            now = _content(cell)
            if now is not value and not same_number(now, value):
                return False
        return True

    def arrays(self) -> list[str]:
        """The names of the arrays that are read."""
        return [name for _, name, value in self.places if isinstance(value, np.ndarray)] + [
            name for function, _, _ in self.functions for name, cell in zip(
                function.__code__.co_freevars, function.__closure__ or ()) if isinstance(_content(cell), np.ndarray)]

    def _add(self, function: FunctionType) -> None:
        if id(function) in self._seen:
            return
        self._seen.add(id(function))
        function, bound = given(function)
        self.functions.append((function, function.__code__, function.__defaults__))
        for value in (*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()):
            if isinstance(value, FunctionType):
                self._add(value)
        code, keywords = function.__code__, _Keywords(function)
        for name in code.co_varnames[code.co_argcount:code.co_argcount + code.co_kwonlyargcount]:
            self.places.append((keywords, name, keywords.get(name, _ABSENT)))
        names = _names(function.__code__)
        for value in bound.values():
            self._follow(value, names)
        for cell in function.__closure__ or ():
            self.cells.append((cell, _content(cell)))
            self._follow(_content(cell), names)
        for name in names:
            if name in function.__globals__:
                value = function.__globals__[name]
                self.places.append((function.__globals__, name, value))
                self._follow(value, names)

    def _follow(self, value: Any, names: tuple[str, ...]) -> None:
        if isinstance(value, ModuleType):
            if value.__name__.partition(".")[0] in _LIBRARIES or (id(value), names) in self._seen:
                return
            self._seen.add((id(value), names))
            space = vars(value)
            for name in names:  # `module.G` names both; a name too many costs a look-up, no more
                if name in space:
                    self.places.append((space, name, space[name]))
                    self._follow(space[name], names)
            return
        if isinstance(value, (list, tuple)) and not hasattr(value, "_fields"):
            self.places.append((_Content(value), "", frozen(value)))
            return
        if sparse_format(value) is not None:    # its arrays are hidden arguments, by their identity
            self.places += [(vars(value), name, part) for name, part in vars(value).items()]
            return
        spaces = None if isinstance(value, FunctionType) else holders.places(value)
        if spaces is not None:
            self._hold(value, spaces, names)
            return
        inner = python_function(value)
        if inner is not None and (inner.__module__ or "").partition(".")[0] not in _LIBRARIES:
            self._add(inner)


    def _hold(self, value: Any, spaces: list[Mapping[str, Any]], names: tuple[str, ...]) -> None:
        """What a holder has under the names of a function, or all items of a dictionary; what an object has not may be
        given to it, and then hides what its class has."""
        if (id(value), names) in self._seen:
            return
        self._seen.add((id(value), names))
        for name in value if isinstance(value, dict) else names:
            if any(name in space for space in spaces):
                self.places += [(space, name, space.get(name, _ABSENT)) for space in spaces]
                self._follow(next(space[name] for space in spaces if name in space), names)


class _Keywords(dict):
    """Has the defaults of a function's keyword-only parameters, as they are when it is asked."""

    def __init__(self, function: FunctionType):
        self.function = function

    def get(self, key: str, default: Any = None) -> Any:
        return (self.function.__kwdefaults__ or {}).get(key, default)


class _Content(dict):
    """Has the items of a list or tuple, as they are when it is asked."""

    def __init__(self, items: list[Any] | tuple[Any, ...]):
        self.items_now = items

    def get(self, key: str, default: Any = None) -> Any:
        return frozen(self.items_now)


def frozen(value: Any) -> Any:
    """The items of nested lists, as tuples."""
    return tuple(map(frozen, value)) if isinstance(value, (list, tuple)) else value


def _names(code: CodeType) -> tuple[str, ...]:
    """Global and attribute names in a code object and those nested in it, each once."""
    return tuple(dict.fromkeys(name for part in _codes(code) for name in part.co_names))


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _content(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not bound yet
        return _ABSENT
