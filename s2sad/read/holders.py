"""What holds values of a module or closure under constant names: a dictionary, an object, a class.

    CONF["dt"], params.dt, Constants.g   ->   const.CONF_dt, const.params_dt, const.Constants_g

A value that is set anew is seen at the next call: `places` is what the watch goes through.
"""
from __future__ import annotations

import re
import types
from collections.abc import Callable, Mapping
from typing import Any

from s2sad.read.meaning import Meaning, Unusable
from s2sad.structure import record_fields

_LIBRARIES = ("numpy", "numba", "scipy", "math", "s2sad")
Mean = Callable[[str, Any], Meaning]


def places(value: Any) -> list[Mapping[str, Any]] | None:
    """Where the values of a holder lie, the first that has a name gives its value; None for what is no holder.

    >>> places({"dt": 0.1}), places({1: 0.1}), places(0.5)
    ([{'dt': 0.1}], None, None)
    """
    if isinstance(value, dict):
        plain = type(value).__getitem__ is dict.__getitem__ and all(isinstance(k, str) for k in value)
        return [value] if plain else None
    if isinstance(value, tuple):
        names = getattr(type(value), "_fields", None)
        return None if names is None else [dict(zip(names, value))]
    kind = value if isinstance(value, type) else type(value)
    if kind.__module__.partition(".")[0] in _LIBRARIES or hasattr(kind, "__getattr__") or isinstance(
            value, (types.FunctionType, types.MethodType, types.ModuleType)):
        return None
    if isinstance(value, type):
        return [vars(c) for c in kind.__mro__[:-1]] if record_fields(kind) is None and kind.__module__ != "builtins" \
            else None
    plain = kind.__getattribute__ in (object.__getattribute__, types.SimpleNamespace.__getattribute__)
    if not plain or not hasattr(value, "__dict__"):
        return None
    return [vars(value), *(vars(c) for c in kind.__mro__[:-1])]


class HolderScope:
    """The names of a holder, an item's as `[key]`; `mean` says what a value means."""

    def __init__(self, name: str, value: Any, mean: Mean):
        self.name, self.value, self.mean = name, value, mean

    def lookup(self, name: str) -> Meaning | None:
        is_item = name.startswith("[")
        key = name[1:-1] if is_item else name
        spaces = places(self.value) or [] if is_item == isinstance(self.value, dict) else []
        found = next((space for space in spaces if key in space), None)
        if found is None:
            return None
        own_class = isinstance(self.value, type)
        of_class = next((space[key] for space in spaces[1:] if key in space), None)
        if isinstance(of_class, property) and not own_class:     # it comes before what the object itself holds
            return Unusable("a property", "write it as a method or a function")
        value, own = found[key], found is spaces[0] and not own_class
        if isinstance(value, staticmethod):
            value = value.__func__
        elif isinstance(value, classmethod):
            value = types.MethodType(value.__func__, self.value if own_class else type(self.value))
        elif isinstance(value, types.FunctionType) and not (own or own_class):
            value = types.MethodType(value, self.value)
        elif not own and not isinstance(value, types.FunctionType) and hasattr(type(value), "__get__"):
            return Unusable("a property", "write it as a method or a function")
        return self.mean(f"{self.name}_" + re.sub(r"\W", "_", key), value)

    def known(self) -> list[str]:
        names = [n for space in places(self.value) or () for n in space if not n.startswith("__")]
        return [f"[{n}]" for n in names] if isinstance(self.value, dict) else names
