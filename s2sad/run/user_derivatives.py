"""The user's own derivatives in modules for NumPy: what they must not write is read-only, and what they return is
looked at. Numba's types say the second; the first is not looked at in compiled code.
"""
from __future__ import annotations

import numbers
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

from s2sad.units import Units

_HALVES = {"forward": "the first half of the adjoint", "reverse": "the second half of the adjoint", "primal": "itself"}


def checked_derivatives(module: ModuleType, units: Units) -> ModuleType:
    """A generated module whose functions of the user's raise when they store or return what they should not."""
    fixed: dict[int, frozenset[int]] = {}
    said: dict[int, tuple[str, str]] = {}
    for unit in units.made.values():
        own = unit.kernel.own
        for what, derivative in (own.functions if own is not None else {}).items():
            if own is not None and what != "solver":
                places = frozenset(k for k, (role, p) in enumerate(own.roles[what])
                                   if role == "primal" and p not in unit.owner.written)
                fixed[id(derivative.function)] = fixed.get(id(derivative.function), places) & places
                said[id(derivative.function)] = what, own.title
    space = vars(module)
    space.update({name: _checked(value, fixed[id(value)], *said[id(value)]) for name, value in list(space.items())
                  if id(value) in fixed})
    return module


def _checked(function: Callable[..., Any], fixed: frozenset[int], what: str, title: str) -> Callable[..., Any]:
    def called(*arguments: Any) -> Any:
        result = function(*(_reading(a) if k in fixed and isinstance(a, np.ndarray) else a
                            for k, a in enumerate(arguments)))
        numbered = _numbers(result, what)
        if not all(isinstance(n, numbers.Real) for n in numbered):
            raise TypeError(f"{function.__name__}, {_HALVES.get(what, f'the {what}')} of {title}, must return numbers, "
                            f"but returned {result!r}")
        if what == "forward" and any(np.may_share_memory(k, a) for k in _arrays(result) for a in _arrays(arguments)):
            raise TypeError(f"{function.__name__} keeps memory of its arguments, which may change: keep a copy")
        return result
    return called


def _arrays(value: Any) -> list[np.ndarray]:
    """The arrays in a value, in tuples and lists too."""
    if isinstance(value, (tuple, list)):
        return [a for item in value for a in _arrays(item)]
    return [value] if isinstance(value, np.ndarray) else []


def _reading(array: np.ndarray) -> np.ndarray:
    """A read-only view."""
    view = array.view()
    view.flags.writeable = False
    return view


def _numbers(result: Any, what: str) -> tuple[Any, ...]:
    """What must be numbers of what a function returned; what a first half keeps may be anything."""
    if what == "forward":
        first = result[0] if isinstance(result, tuple) and len(result) == 2 else ()
        return first if isinstance(first, tuple) else (first,) if isinstance(first, numbers.Number) else ()
    return () if result is None else result if isinstance(result, tuple) else (result,)
