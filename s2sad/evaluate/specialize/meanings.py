"""What reading has found as values, and what residual names mean.
"""
from __future__ import annotations

import importlib
import types
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.classes.class_lookup import class_value, library_value_of
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.values import Data, FunctionValue, LibraryValue, ObjectValue, ScopeValue, Value, constant
from s2sad.evaluate.specialize.live_values import STANDARD
from s2sad.live_objects.guards import ABSENT, taken
from s2sad.read.outside_values import (
    Array, Library, LibraryScope, Matrix, Meaning, ModuleValue, Namespace, Number, NumberTable, Record, StringValue,
    Surroundings, UserFunctionValue, library_value,
)
from s2sad.rules.spellings import is_scipy
from s2sad.tree import AST


# -- meanings --------------------------------------------------------------------------------------------------------
@operation
def meaning_value(ev: Evaluator, name: str, meaning: Meaning, node: AST, f: Frame) -> Value:
    """What reading has found as a value."""
    if isinstance(meaning, _Live):
        return ev.outside_value(meaning.name, meaning.value, node, f)
    if isinstance(meaning, Library):
        return _library(ev, meaning.path, node)
    if isinstance(meaning, StringValue):
        return constant(meaning.value)
    if isinstance(meaning, UserFunctionValue) and isinstance(meaning.handle, types.FunctionType):
        return ev.outside_value(name, meaning.handle, node, f)
    if isinstance(meaning, UserFunctionValue):
        return ev.file_function(meaning.handle)
    if isinstance(meaning, Number):
        return Data(tree.at(tree.name(outside_name_of(ev, meaning)), node), meaning.value)
    if isinstance(meaning, Matrix):
        return ev.outside_matrix(meaning, node, f)
    if isinstance(meaning, Array) and not isinstance(meaning, NumberTable):
        rank = getattr(meaning.value, "ndim", None)      # guarded, the lengths are not
        named = tree.at(tree.name(outside_name_of(ev, meaning)), node)
        return Data(named, shape=None if rank is None else (None,) * rank)
    if isinstance(meaning, Record):
        return class_value(meaning.value)
    if isinstance(meaning, ModuleValue) and not isinstance(meaning, Namespace):
        module = getattr(meaning.scope, "module", None)
        if isinstance(meaning.scope, LibraryScope):
            return _member_of_library(ev, name, meaning, node, f)
        return ScopeValue(meaning.name, _Members(module) if isinstance(module, types.ModuleType) else meaning.scope)
    what = getattr(meaning, "what", "") or "of a kind that is not supported"
    is_what = "is" if what.startswith("imported") else "cannot be used in a kernel: it is"
    raise ev.outside_error(node, f"'{name}' {is_what} {what}",
                           getattr(meaning, "help", ""))


def _member_of_library(ev: Evaluator, name: str, meaning: ModuleValue, node: AST, f: Frame) -> Value:
    """A library's module, or something of it that was not looked up there; Python's own library is there always."""
    root, *rest = meaning.name.split(".")
    if root in STANDARD and rest:
        found: Any = importlib.import_module(root)
        for part in rest:
            found = getattr(found, part, None)
        return ScopeValue(meaning.name, meaning.scope) if isinstance(found, types.ModuleType) else ev.outside_value(
            name, found, node, f)
    if rest and root in ("numba", "s2sad") or is_scipy(meaning.name):
        return LibraryValue(meaning.name)
    return ScopeValue(meaning.name, meaning.scope)


@dataclass(frozen=True)
class _Members:
    """A module's names, with values as they are."""
    module: types.ModuleType

    def lookup(self, name: str) -> Any:
        found = taken(self.module, "own", name)
        if found is ABSENT:
            found = taken(self.module, "attribute", name)
        return None if found is ABSENT else _Live(name, found)


@dataclass(frozen=True)
class _Live:
    name: str
    value: Any


def _library(ev: Evaluator, path: str, node: AST) -> Value:
    """A library's function, or a constant of it."""
    value = library_value(path)
    if isinstance(value, (bool, str)) or value is None and path.endswith((".newaxis", ".None")):
        return Data(tree.at(tree.const(value), node), value)
    if isinstance(value, float):
        return Data(tree.at(tree.name(ev.library(path)), node), value)
    return library_value_of(path)


@operation
def library_member(ev: Evaluator, path: str, name: str, node: AST) -> Value:
    """An attribute of something of a library: a function of a type, say."""
    return _library(ev, f"{path}.{name}", node)


@operation
def outside_name_of(ev: Evaluator, meaning: Number | Array) -> str:
    """The residual name of a number or an array from outside."""
    for name, known in ev.outside.items():
        if known is meaning or type(known) is type(meaning) and known.name == meaning.name and (  # pyright: ignore
                known.value is meaning.value):  # pyright: ignore
            return name
    name = f"outside.{len(ev.outside)}"
    ev.outside[name] = meaning
    return name


@operation
def residual_function(ev: Evaluator, function: FunctionValue, node: AST) -> str:
    """The residual name of a function that stays one."""
    if function.handle is None or function.first or function.keywords:
        raise ev.unknown(node, f"the function '{function.captured.name}' is given to what is computed at run time")
    name = f"function.{function.captured.name}.{id(function.handle)}"
    handle = function.handle
    if isinstance(handle, types.FunctionType):
        path = f"{handle.__module__}.{handle.__qualname__}"
        ev.outside[name] = UserFunctionValue(handle.__name__, ("live", id(handle)), path, ev.body_of(handle))
    else:
        ev.outside[name] = UserFunctionValue(handle.__name__, function.key, f"{handle.module.name}.{handle.__name__}",
                                             handle)
    return name


@operation
def residual_object(ev: Evaluator, value: ObjectValue, node: AST) -> str:
    raise ev.unknown(node, f"{value.value!r} is used by what is computed at run time")


class ResidualScope:
    """What the names of a residual function mean."""

    def __init__(self, names: Mapping[str, Meaning], behind: Surroundings):
        self.names, self.behind = names, behind

    def lookup(self, name: str) -> Meaning | None:
        if name in self.names:
            return self.names[name]
        root = name.partition(".")[0]
        if root in ("numpy", "math", "scipy", "builtins", "itertools"):
            return Library(name)
        if hasattr(__import__("builtins"), name):
            return Library(f"builtins.{name}")
        return None

    def known(self) -> list[str]:
        return []

    def imported(self, module: str, level: int, name: str | None) -> Meaning:
        return self.behind.imported(module, level, name)
