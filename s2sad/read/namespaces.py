"""What holds values of a module or closure under constant names: a dictionary, an object, a class.

    CONF["dt"], params.dt, Constants.g   ->   const.CONF_dt, const.params_dt, const.Constants_g

A value that is set anew is seen at the next call: what a name is looked up in is taken through `guards`.
"""
from __future__ import annotations

import re
import types
from collections.abc import Callable
from typing import Any

from s2sad.live_objects.guards import ABSENT, class_attribute, reached, taken
from s2sad.read.outside_values import Meaning, Unusable
from s2sad.pytree import record_fields

_LIBRARIES = ("numpy", "numba", "scipy", "math", "s2sad")
_PLAIN = (object.__getattribute__, types.SimpleNamespace.__getattribute__)
_PROPERTY = Unusable("a property", "write it as a method or a function")
Mean = Callable[[str, Any], Meaning]


def is_holder(value: Any) -> bool:
    """Whether a value holds others under names that mean no more than a place.

    >>> is_holder({"dt": 0.1}), is_holder({1: 0.1}), is_holder(0.5)
    (True, False, False)
    """
    if isinstance(value, dict):
        return type(value).__getitem__ is dict.__getitem__ and all(isinstance(k, str) for k in value)
    if isinstance(value, tuple):
        return hasattr(type(value), "_fields")
    if isinstance(value, (int, float, complex, str)):
        return False    # of a class of the user's, too: since Python 3.12 they look names up as objects do
    made = value if isinstance(value, type) else taken(value, "class")
    if made.__module__.partition(".")[0] in _LIBRARIES or isinstance(
            value, (types.FunctionType, types.MethodType, types.ModuleType)):
        return False
    if taken(made, "attribute", "__getattr__") is not ABSENT:
        return False
    if isinstance(value, type):
        return record_fields(made) is None and made.__module__ != "builtins"
    return taken(made, "attribute", "__getattribute__") in _PLAIN and hasattr(value, "__dict__")


class NamespaceScope:
    """The names of a holder, an item's as `[key]`; `mean` says what a value means."""

    def __init__(self, name: str, value: Any, mean: Mean):
        self.name, self.value, self.mean = name, value, mean

    def lookup(self, name: str) -> Meaning | None:
        is_item = name.startswith("[")
        key = name[1:-1] if is_item else name
        if is_item is not isinstance(self.value, dict):
            return None
        found = self._item(key) if isinstance(self.value, (dict, tuple)) else self._attribute(key)
        if found is ABSENT:
            return None
        return found if isinstance(found, Unusable) else self.mean(f"{self.name}_" + re.sub(r"\W", "_", key), found)

    def _item(self, key: str) -> Any:
        """What a dictionary or a named tuple holds."""
        if isinstance(self.value, tuple):
            return taken(self.value, "attribute", key) if key in _fields(self.value) else ABSENT
        return taken(self.value, "item", key)

    def _attribute(self, key: str) -> Any:
        """What an object or a class holds, a function of a class as Python gives it."""
        own_class = isinstance(self.value, type)
        if own_class and key == "__call__":     # who calls a class makes an object
            return ABSENT
        made = self.value if own_class else taken(self.value, "class")
        value, own = class_attribute(made, key), False
        if not own_class and hasattr(type(value), "__get__") and hasattr(type(value), "__set__"):
            return _PROPERTY    # it comes before what the object itself holds
        if not own_class and key != "__call__" and (held := taken(self.value, "own", key)) is not ABSENT:
            value, own = held, True
        if isinstance(value, staticmethod):
            reached(value, "part", "__func__", value.__func__)
            return value.__func__
        if isinstance(value, classmethod):
            return self._bound(value.__func__, made, key)
        if own or own_class:
            return value
        if isinstance(value, types.FunctionType):
            return self._bound(value, self.value, key)
        return _PROPERTY if hasattr(type(value), "__get__") else value

    def _bound(self, function: Any, first: Any, key: str) -> types.MethodType:
        return reached(self.value, "bound", key, types.MethodType(function, first))

    def known(self) -> list[str]:
        if isinstance(self.value, dict):
            return [f"[{n}]" for n in taken(self.value, "keys")]
        if isinstance(self.value, tuple):
            return list(_fields(self.value))
        classes = (self.value if isinstance(self.value, type) else type(self.value)).__mro__[:-1]
        holders = classes if isinstance(self.value, type) else (self.value, *classes)
        return [n for holder in holders for n in vars(holder) if not n.startswith("__")]


def _fields(value: tuple[Any, ...]) -> tuple[str, ...]:
    return getattr(type(value), "_fields", ())
