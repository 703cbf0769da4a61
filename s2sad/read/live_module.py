"""What a name means around a live function: its closure, its module, the modules and objects that these hold."""
from __future__ import annotations

import functools
import importlib
import sys
import types
from collections.abc import Callable, Mapping
from typing import Any

import numpy

from s2sad.live_objects.guards import ABSENT, VaryingNumber, reached, taken
from s2sad.read import namespaces
from s2sad.read.outside_values import (
    AST, Array, UserFunctionValue, Namespace, Library, LibraryScope, Meaning, NotConstant, Number, ModuleValue,
    StringValue, Unusable, is_numbers, kind_of, library_path, value_meaning,
)
from s2sad.live_objects.unwrap import default_values, named_function
from s2sad.live_objects.registry import GIVEN, ROOM


class LiveScope:
    """What a function was given already, its closure, module and builtins, in this order."""

    def __init__(self, function: types.FunctionType, given: Mapping[str, Any]):
        self.function, self.given = function, given
        self.cells = taken(function, "code").co_freevars

    def value(self, name: str) -> Any:
        """The value now; raises KeyError if there is none."""
        if name in self.given:
            return self.given[name]
        found = taken(self.function, "cell" if name in self.cells else "global", name)
        if found is ABSENT and name not in self.cells:
            found = taken(None, "builtin", name)
        if found is ABSENT:
            raise KeyError(name)
        return found

    def lookup(self, name: str) -> Meaning | None:
        try:
            return live_meaning(name, self.value(name))
        except KeyError:
            return None

    def known(self) -> list[str]:
        return [*self.given, *self.cells, *self.function.__globals__]

    def imported(self, module: str, level: int, name: str | None) -> Meaning:
        """What an import in the function binds: a module, or what it has under a name."""
        try:
            found = importlib.import_module("." * level + module, taken(self.function, "global", "__package__") or None)
            if name is not None and not hasattr(found, name):
                importlib.import_module(f"{found.__name__}.{name}")
        except ImportError as error:
            return Unusable(f"imported, which fails: {error}", "correct the import")
        found = taken(None, "module", found.__name__)
        value = found if name is None else _member(found, name)
        if value is ABSENT:
            return Unusable(f"imported, which fails: module '{found.__name__}' has no attribute '{name}'",
                            "correct the import")
        return live_meaning(name or module, value)


class ModuleScope:
    """The names of a user's module that is loaded."""

    def __init__(self, module: types.ModuleType):
        self.module = module

    def lookup(self, name: str) -> Meaning | None:
        value = _member(self.module, name)
        if value is ABSENT:
            return None
        meaning = live_meaning(name, value)
        if isinstance(meaning, Unusable) and callable(value):
            return Library(f"{self.module.__name__}.{name}")
        return meaning

    def known(self) -> list[str]:
        return [n for n in dir(self.module) if not n.startswith("_")]


def _member(module: types.ModuleType, name: str) -> Any:
    """What a module has under a name, in its dictionary or by a function of its own that says what."""
    value = taken(module, "own", name) if type(module) is types.ModuleType else ABSENT
    return taken(module, "attribute", name) if value is ABSENT else value


def is_read(value: Any) -> bool:
    """Whether a function or a class of this package is read like a user's."""
    return GIVEN.own(value) is not None or value.__module__.startswith("s2sad.evaluate.library.")


def live_meaning(name: str, value: Any) -> Meaning:
    """What a live value means to a kernel that names it."""
    if isinstance(value, VaryingNumber):
        return Array(name, value)
    given = GIVEN.of(value) or GIVEN.of(named_function(value))
    if given is not None:
        return Library(ROOM + given.path)
    if isinstance(value, types.ModuleType):
        library = value.__name__.partition(".")[0] in ("numpy", "math", "numba", "s2sad")
        return ModuleValue(value.__name__, LibraryScope(value.__name__) if library else ModuleScope(value))
    path = library_path(name, value) if value is not None or name != "newaxis" else "numpy.newaxis"
    if path is not None:
        return Library(path)
    if isinstance(value, functools.partial) and _home(value.func) in ("numba", "s2sad"):
        value = value.func
    if _home(value) in ("numba", "s2sad") and named_function(value) in (None, value) and not is_read(value):
        word = getattr(value, "__name__", name)
        if value.__module__.startswith("s2sad.runtime"):
            return Library(f"runtime.{word}")
        if getattr(value, "__module__", "") == "numba.core.decorators":
            word = "jit"  # also what `njit(...)` gives back, called `wrapper`
        return Library("builtins.range") if word == "prange" else Library(f"{_home(value)}.{word}")
    function = named_function(value)
    if function is not None:
        reached(value, "function", "", function)
        path = f"{function.__module__}.{function.__qualname__}"
        word = name if function.__name__ == "<lambda>" else function.__name__
        return UserFunctionValue(word, ("live", id(function)), path, function)
    if isinstance(value, numpy.ufunc):
        return _ufunc(value)
    if isinstance(value, functools._lru_cache_wrapper):
        return Unusable("a function behind a cache, whose results are one object for all calls",
                        f"call the function inside: give it a name, as in inner = {name}.__wrapped__")
    if namespaces.is_holder(value):
        what = "a class" if isinstance(value, type) else kind_of(value)
        return Namespace(name, namespaces.NamespaceScope(name, value, live_meaning), what)
    if isinstance(value, (list, tuple)):
        return value_meaning(name, value, taken(value, "items"))
    return value_meaning(name, value)


def _ufunc(value: numpy.ufunc) -> Meaning:
    """A function of another library for arrays, of which nobody can read what it does."""
    home = "scipy.special"
    if getattr(sys.modules.get(home), value.__name__, None) is value:
        return Library(f"{home}.{value.__name__}")
    return Unusable("a ufunc", "call it in a function of its own, and give that its derivative with s2sad.rule")


def _home(value: Any) -> str:
    module = getattr(value, "__module__", None) if callable(value) else None
    return module.partition(".")[0] if isinstance(module, str) else ""


def defaults_of(function: types.FunctionType) -> Callable[[str, AST], Any]:
    """Looks up a parameter's default value as the live function has it."""
    values = default_values(function)

    def default(parameter: str, node: AST) -> Any:
        value = values.get(parameter)
        if value is None or isinstance(live_meaning(parameter, value), (Number, StringValue)) or isinstance(value,
                                                                                                            float):
            return value
        if is_numbers(value, tuple):
            return value
        raise NotConstant(live_meaning(parameter, value))
    return default
