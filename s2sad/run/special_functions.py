"""SciPy's special functions for compiled code: Numba calls the C functions that `scipy.special.cython_special` names.

    total += special.j0(k * r[i])       a call of `j0` of SciPy's, for Numba as for NumPy

Each is registered once in a process, before a module that calls it is compiled or its machine code is loaded, which
knows it by a symbol.
"""
from __future__ import annotations

import ctypes
import importlib
import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

_SIGNATURE = re.compile(r"double \(((?:double, )*)(?:double, )?int __pyx_skip_dispatch\)")
_ARGUMENTS = ("a", "b", "c", "d", "e")


def used(space: Mapping[str, Any]) -> list[str]:
    """The special functions that the functions of a module's namespace may call."""
    special = sys.modules.get("scipy.special")
    if special is None:
        return []
    functions = [v for v in space.values() if isinstance(v, FunctionType)]
    is_there = any(v is special for v in space.values())       # `in` would ask arrays whether they are equal
    attributes = {n for f in functions for n in f.__code__.co_names} if is_there else set()
    imported = {v.__name__ for v in space.values() if isinstance(v, np.ufunc)}
    return sorted(n for n in attributes | imported if isinstance(getattr(special, n, None), np.ufunc))


def register(names: Iterable[str]) -> None:
    """Makes special functions known to Numba; one that SciPy has no C function of floats for stays unknown."""
    for name in names:
        _registered(name)


@cache
def _registered(name: str) -> bool:
    numba = importlib.import_module("numba")
    special = importlib.import_module("scipy.special")
    found = _address(importlib.import_module("scipy.special.cython_special"), name)
    function = getattr(special, name, None)
    if found is None or function is None:
        return False
    address, count = found
    symbol = f"s2sad_special_{name}"
    importlib.import_module("llvmlite.binding").add_symbol(symbol, address)
    floats = (numba.float64,) * count
    space: dict[str, Any] = {"called": numba.types.ExternalFunction(symbol, numba.float64(*floats, numba.intc)),
                             "np": np, "numba": numba, "types": numba.types}
    arguments = ", ".join(_ARGUMENTS[:count])
    exec(_TEXT.format(arguments=arguments, floats=", ".join(f"float({a})" for a in _ARGUMENTS[:count])), space)
    numba.extending.overload(function)(space["typed"])
    return True


_TEXT = """
def typed({arguments}):
    kinds = ({arguments},)
    if all(kind == types.float32 for kind in kinds):
        return lambda {arguments}: np.float32(called({floats}, 0))
    if all(isinstance(kind, (types.Float, types.Integer, types.Boolean)) for kind in kinds):
        return lambda {arguments}: called({floats}, 0)
    if any(isinstance(kind, types.Array) for kind in kinds):
        return lambda {arguments}: of_arrays({arguments})
    return None


def of_numbers({arguments}):
    return called({floats}, 0)


of_arrays = numba.vectorize(of_numbers)
"""


def _address(module: ModuleType, name: str) -> tuple[int, int] | None:
    """The address of a C function of floats, and how many it takes; None if SciPy has none."""
    named, pointer = ctypes.pythonapi.PyCapsule_GetName, ctypes.pythonapi.PyCapsule_GetPointer
    named.restype, named.argtypes = ctypes.c_char_p, [ctypes.py_object]
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    functions = getattr(module, "__pyx_capi__", {})
    for key, capsule in functions.items():
        if key != name and re.sub(r"^__pyx_fuse(_\d+)+", "", key) != name:
            continue
        signature = named(capsule)
        count = signature.decode().count("double") - 1
        if _SIGNATURE.fullmatch(signature.decode()) and 1 <= count <= len(_ARGUMENTS):
            return pointer(capsule, signature), count
    return None
