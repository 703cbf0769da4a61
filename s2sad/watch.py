"""What a function reads from outside itself, so that a derivative made for other values is never run.

Numba freezes globals, and so does a generated file; a constant that was changed since would give a stale gradient.
"""
from __future__ import annotations

from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from s2sad.binding import same_number

_ABSENT = object()
_LIBRARIES = ("numpy", "math", "builtins", "numba", "scipy")


def plain_function(value: Any) -> Any:
    """The Python function behind a differentiated one or a Numba dispatcher, else the value itself."""
    for attribute in ("__wrapped_kernel__", "py_func"):
        value = getattr(value, attribute, value) if not isinstance(value, (FunctionType, type)) else value
    return value


class Watch:
    """The globals and closure cells that a function and the functions it calls read, with their values now.

    Numbers are compared by value; arrays, functions and everything else by identity (an array's content is read at
    each call). `unchanged()` costs a dictionary look-up for each.
    """

    def __init__(self, function: FunctionType):
        self.places: list[tuple[dict[str, Any], str, Any]] = []
        self.cells: list[tuple[Any, Any]] = []
        self._seen: set[int] = set()
        self._add(function)

    def unchanged(self) -> bool:
        for space, name, value in self.places:
            now = space.get(name, _ABSENT)
            if now is not value and not same_number(now, value):
                return False
        for cell, value in self.cells:
            now = _content(cell)
            if now is not value and not same_number(now, value):
                return False
        return True

    def _add(self, function: FunctionType) -> None:
        if id(function) in self._seen:
            return
        self._seen.add(id(function))
        for cell in function.__closure__ or ():
            self.cells.append((cell, _content(cell)))
            self._follow(_content(cell), ())
        names = _names(function.__code__)
        for name in names:
            if name in function.__globals__:
                value = function.__globals__[name]
                self.places.append((function.__globals__, name, value))
                self._follow(value, names)

    def _follow(self, value: Any, names: tuple[str, ...]) -> None:
        if isinstance(value, ModuleType):
            if value.__name__.partition(".")[0] in _LIBRARIES or id(value) in self._seen:
                return
            space = vars(value)
            for name in names:  # `module.G` names both; a name too many costs a look-up, no more
                if name in space and isinstance(space[name], (int, float, np.generic, np.ndarray, FunctionType)):
                    self.places.append((space, name, space[name]))
                    self._follow(space[name], ())
            return
        inner = plain_function(value)
        if isinstance(inner, FunctionType) and (inner.__module__ or "").partition(".")[0] not in _LIBRARIES:
            self._add(inner)


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
