"""What a function reads from outside itself, so that a derivative made for other values is never run.

Numba freezes globals, and so does a generated file; a constant that was changed since would give a stale gradient.
"""
from __future__ import annotations

from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from s2sad.binding import same_number
from s2sad.read.capture import python_function

_ABSENT = object()
_HOLDERS = (dict, list, type)
_FOLLOWED = (int, float, np.generic, np.ndarray, ModuleType, tuple, *_HOLDERS)
_LIBRARIES = ("numpy", "math", "builtins", "numba", "scipy")


class Watch:
    """The globals and closure cells that a function and the functions it calls read, with their values now, and the
    code and defaults of these functions.

    Numbers are compared by value, also those in dicts, lists and classes; arrays, functions and everything else by
    identity (an array's content is read at each call). `unchanged()` costs a dictionary look-up for each.
    """

    def __init__(self, function: FunctionType):
        self.functions: list[tuple[FunctionType, CodeType, Any]] = []
        self.places: list[tuple[dict[str, Any], str, Any]] = []
        self.cells: list[tuple[Any, Any]] = []
        self.holders: list[tuple[Any, Any]] = []    # dicts, lists and classes, with what they held
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
        return all(_holds(holder, held) for holder, held in self.holders)

    def arrays(self) -> list[str]:
        """The names of the arrays that are read."""
        return [name for _, name, value in self.places if isinstance(value, np.ndarray)] + [
            name for function, _, _ in self.functions for name, cell in zip(
                function.__code__.co_freevars, function.__closure__ or ()) if isinstance(_content(cell), np.ndarray)]

    def _add(self, function: FunctionType) -> None:
        if id(function) in self._seen:
            return
        self._seen.add(id(function))
        self.functions.append((function, function.__code__, function.__defaults__))
        names = _names(function.__code__)
        for cell in function.__closure__ or ():
            self.cells.append((cell, _content(cell)))
            self._follow(_content(cell), names)
        for name in names:
            if name in function.__globals__:
                value = function.__globals__[name]
                self.places.append((function.__globals__, name, value))
                self._follow(value, names)

    def _follow(self, value: Any, names: tuple[str, ...]) -> None:
        if isinstance(value, _HOLDERS):
            self.holders.append((value, _held(value)))
            return
        if isinstance(value, ModuleType):
            if value.__name__.partition(".")[0] in _LIBRARIES or (id(value), names) in self._seen:
                return
            self._seen.add((id(value), names))
            space = vars(value)
            for name in names:  # `module.G` names both; a name too many costs a look-up, no more
                if isinstance(space.get(name), _FOLLOWED) or python_function(space.get(name)) is not None:
                    self.places.append((space, name, space[name]))
                    self._follow(space[name], names)
            return
        inner = python_function(value)
        if inner is not None and (inner.__module__ or "").partition(".")[0] not in _LIBRARIES:
            self._add(inner)


def _items(value: Any) -> dict[Any, Any] | None:
    """What a dict, a list, a tuple or a class holds, by key."""
    if isinstance(value, type):
        return {k: v for k, v in vars(value).items() if isinstance(v, (int, float, np.generic, tuple, list, dict))}
    if isinstance(value, (list, tuple)):
        return dict(enumerate(value))
    return dict(value) if isinstance(value, dict) else None


def _held(value: Any) -> Any:
    """A value as it is now, what it holds copied."""
    items = _items(value)
    return value if items is None else {k: _held(v) for k, v in items.items()}


def _holds(value: Any, held: Any) -> bool:
    """Whether a value still holds what it held."""
    items = _items(value)
    if items is None:
        return value is held or same_number(value, held)
    return isinstance(held, dict) and items.keys() == held.keys() and all(_holds(v, held[k]) for k, v in items.items())


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
