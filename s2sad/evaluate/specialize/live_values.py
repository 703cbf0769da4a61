"""What names from outside mean: live values, taken through the guards.
"""
from __future__ import annotations

import collections
import contextlib
import functools
import logging
import random
import re
import sys
import types
from collections.abc import Mapping
from dataclasses import replace
from enum import Enum
from typing import Any

import numpy

from s2sad import tree
from s2sad.diagnostics import Source
from s2sad.evaluate.specialize.classes.class_lookup import class_value, library_value_of
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.signals import Reached
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import (
    NONE, ClassValue, Data, FunctionValue, LibraryValue, ObjectValue, TupleValue, Value, constant,
)
from s2sad.live_objects.guards import ABSENT, VaryingNumber, reached, taken
from s2sad.live_objects.unwrap import CalledDerivative, default_values, named_function
from s2sad.read.capture import captured_of
from s2sad.read.live_module import LiveScope, live_meaning
from s2sad.read.outside_values import Captured, Library, Matrix, Namespace, kind_of, library_path
from s2sad.tree import AST

STANDARD = ("functools", "itertools", "operator", "collections", "copy", "sys", "os", "logging", "typing", "abc",
             "enum", "dataclasses", "contextlib", "warnings", "time", "heapq", "bisect")
_CALLED = ("s2sad.interface.drivers", "s2sad.interface.jax_names", "s2sad.jacobians.second_order")
_CONTEXT_MANAGER = contextlib.contextmanager(iter).__code__        # of what is decorated so


@operation
def outside_name(ev: Evaluator, name: str, node: AST, f: Frame) -> Value:
    """What a name means that no frame has."""
    scope = f.captured.scope
    if isinstance(scope, LiveScope):
        try:
            value = scope.value(name)
        except KeyError:
            raise ev.refusal(node, f"'{name}' is not defined", code="S202") from None
        return outside_value(ev, name, value, node, f)
    return ev.scope_value(scope, name, node, f)


@operation
def outside_value(ev: Evaluator, name: str, value: Any, node: AST, f: Frame) -> Value:
    """A live value."""
    met = ev.met_in_advance(value, node, f)
    if met is not None:
        return met
    if isinstance(value, VaryingNumber) or value is None or isinstance(value, (bool, int, float, complex, str)) and (
            not isinstance(value, Enum)):
        return _plain(ev, name, value, node, f)
    if value is ... or value is NotImplemented:
        return constant(value) if value is ... else LibraryValue("builtins.NotImplemented")
    if isinstance(value, Enum):
        return member(ev, value)
    if value is sys.float_info:
        return ObjectValue(value, "sys.float_info")
    if isinstance(value, logging.Logger):
        return LibraryValue("logging")
    if type(value) is functools.partial:
        return _partial(ev, value, name, node, f)
    if isinstance(value, functools._lru_cache_wrapper):
        return LibraryValue("functools.cached", (ev.live_function(taken(value, "attribute", "__wrapped__"), node, f),))
    if type(value) is numpy.vectorize:
        return ev.live_vectorized(value, name, node, f)
    standard = _standard(value)
    if standard:
        return LibraryValue(standard)
    if isinstance(value, types.MethodType):
        return _method(ev, value, name, node, f)
    if isinstance(value, (list, tuple, dict, set, frozenset)):
        plain = (list, tuple, dict, set, frozenset, collections.OrderedDict, collections.defaultdict)
        if type(value) not in plain and not hasattr(type(value), "_fields"):
            raise ev.outside_error(node, f"'{name}' cannot be used in a kernel: it is {kind_of(value)}",
                                   "make it a plain dict, list or tuple")
        return _container(ev, name, value, node, f)
    if isinstance(value, (numpy.ndarray, numpy.generic)) or isinstance(value, types.ModuleType):
        return ev.meaning_value(name, live_meaning(name, value), node, f)
    if isinstance(value, CalledDerivative):
        return _derivative(ev, value, node, f)
    path = library_path(name, value) or _drawing(value) or _own(value)
    if path is not None:
        return library_value_of(path)
    if isinstance(value, type):
        return _class(ev, value, name, node, f)
    if getattr(value, "__code__", None) is _CONTEXT_MANAGER:
        inner = outside_value(ev, name, taken(value, "attribute", "__wrapped__"), node, f)
        return LibraryValue("contextlib.entered", (inner,))
    function = named_function(value)
    if function is not None:
        return live_function(ev, value, node, f)
    meaning = live_meaning(name, value)
    if isinstance(meaning, Namespace) and type(value).__module__ not in ("builtins",):
        return _object(ev, name, value)
    if hasattr(value, "__slots__") and not isinstance(meaning, (Library, Matrix)):
        return _object(ev, name, value)
    return ev.meaning_value(name, meaning, node, f)


def _own(value: Any) -> str | None:
    """The path of a function of this package that is called in kernels."""
    home, name = getattr(value, "__module__", None), getattr(value, "__name__", "")
    return f"s2sad.{name}" if home in _CALLED else None


def _derivative(ev: Evaluator, value: CalledDerivative, node: AST, f: Frame) -> LibraryValue:
    """A derivative that was made outside, with its function and what it is with respect to."""
    ev.held.append(value)
    said, function = taken(value, "attribute", "names"), taken(value, "attribute", "__wrapped__")
    names = tuple(map(constant, said)) if said is not None else None
    of = outside_value(ev, getattr(function, "__name__", "f"), function, node, f)
    path = taken(value, "attribute", "path")
    return LibraryValue(f"s2sad.called.{path}", (of, NONE if names is None else TupleValue(names)))


def _drawing(value: Any) -> str | None:
    """The path of a function that draws random numbers from a sequence that all share."""
    owner = type(getattr(value, "__self__", None))
    home = {numpy.random.RandomState: "numpy.random", random.Random: "random"}.get(owner)
    return f"{home}.{value.__name__}" if home is not None and callable(value) else None


def _standard(value: Any) -> str:
    """The path of a function of Python's library that is known here."""
    home = getattr(value, "__module__", None)
    name = getattr(value, "__qualname__", getattr(value, "__name__", ""))
    if isinstance(home, str) and callable(value) and not isinstance(value, types.MethodType):
        root = {"_functools": "functools", "_operator": "operator", "_collections": "collections",
                "_warnings": "warnings", "_heapq": "heapq", "_bisect": "bisect"}.get(home, home)
        if root.partition(".")[0] in STANDARD:
            return f"{root}.{name}"
        if home == "builtins" and (isinstance(value, type) or isinstance(value, types.BuiltinFunctionType)) and (
                getattr(__import__("builtins"), name, None) is value):
            return f"builtins.{name}"
    return ""


def _plain(ev: Evaluator, name: str, value: Any, node: AST, f: Frame) -> Value:
    if value is None or isinstance(value, (bool, str)):
        return constant(str.__str__(value) if isinstance(value, str) else value)
    return ev.meaning_value(name, live_meaning(re.sub(r"\W+", "_", name).strip("_") or "value", value), node, f)


def _method(ev: Evaluator, value: types.MethodType, name: str, node: AST, f: Frame) -> Value:
    """A bound method: the function of its class, given its object."""
    holder = reached(value, "part", "__self__", value.__self__)
    instance = outside_value(ev, getattr(holder, "__name__", name), holder, node, f)
    kernel = reached(value, "part", "__func__", value.__func__)
    owner = next((class_value(c) for c in type(holder).__mro__ if vars(c).get(kernel.__name__) is kernel), None)
    function = live_function(ev, kernel, node, f, owner)
    return replace(function, first=(instance,)) if isinstance(function, FunctionValue) else function


def _partial(ev: Evaluator, value: functools.partial, name: str, node: AST, f: Frame) -> Value:
    inner = outside_value(ev, name, reached(value, "part", "func", value.func), node, f)
    if not isinstance(inner, (FunctionValue, LibraryValue)):
        raise ev.refusal(node, f"'{name}' is a partial of what is no function")
    args = reached(value, "part", "args", value.args)
    keywords = reached(value, "part", "keywords", value.keywords)
    first = tuple(outside_value(ev, f"{name}_{k}", a, node, f) for k, a in enumerate(args))
    given = {k: outside_value(ev, f"{name}_{k}", taken(keywords, "item", k), node, f) for k in taken(keywords, "keys")}
    return replace(inner, first=(*inner.first, *first), keywords=tuple({**dict(inner.keywords), **given}.items()))


def _container(ev: Evaluator, name: str, value: Any, node: AST, f: Frame) -> Value:
    """A list, tuple, dict or set of a module or an object."""
    if isinstance(value, tuple):
        fields = getattr(type(value), "_fields", None)
        made = class_value(type(value)) if fields is not None else None
        return TupleValue(tuple(outside_value(ev, f"{name}_{fields[k] if fields else k}", v, node, f)
                                for k, v in enumerate(value)), made)
    if id(value) in ev.live:
        return ev.live[id(value)]
    if ev.guarded:
        raise Reached(name, value, ev.owning)
    site = f"live {id(value)}"
    if site in ev.sites and ev.owning and isinstance(value, list):
        taken(value, "items")
        held = [ev.spelled(outside_value(ev, f"{name}_{k}", v, node, f), node) for k, v in enumerate(value)]
        ev.held.append(value)
        ev.live[id(value)] = ev.named(Data(tree.at(tree.List(held, tree.Load()), node), is_list=True), name, node)
        return ev.live[id(value)]
    kind = "list" if isinstance(value, list) else "dict" if isinstance(value, dict) else "set"
    if isinstance(value, set):
        raise ev.refusal(node, f"'{name}' is a set from outside, which may change", help="make it a frozenset")
    reference = ev.live[id(value)] = ev.heap.new(Object(kind, {}, label=name, live=value, is_owned=ev.owning,
                                                       site=site if ev.owning and kind == "list" else None))
    ev.held.append(value)
    try:
        ev.heap.set_items(reference, _outside_items(ev, name, kind, value, node, f))
    except BaseException:
        del ev.live[id(value)]      # what holds it is not there when this is tried again
        raise
    ev.outset[reference.number] = ev.heap[reference]
    return reference


def _outside_items(ev: Evaluator, name: str, kind: str, value: Any, node: AST, f: Frame) -> Mapping[Any, Value]:
    if kind == "dict":
        return {_key(ev, k): outside_value(ev, f"{name}_{k}", taken(value, "item", k), node, f)
                for k in taken(value, "keys")}
    if kind == "list":
        taken(value, "items")
        return {k: outside_value(ev, f"{name}_{k}", v, node, f) for k, v in enumerate(value)}
    return {_key(ev, v): outside_value(ev, name, v, node, f) for v in value}


def _key(ev: Evaluator, key: Any) -> Any:
    if isinstance(key, Enum):
        return member(ev, key)
    if isinstance(key, (types.FunctionType, type)):
        return ObjectValue(key, ("object", id(key)))
    if type(key) in (tuple, frozenset):
        return type(key)(_key(ev, k) for k in key)
    return key


def _object(ev: Evaluator, name: str, value: Any) -> Value:
    """An object of a class of the user's: its attributes are taken when they are asked for."""
    if id(value) not in ev.live:
        if ev.guarded:
            raise Reached(name, value, ev.owning)
        ev.held.append(value)
        made = class_value(taken(value, "class"))
        reference = ev.live[id(value)] = ev.heap.new(Object("record", {}, made, label=name, live=value,
                                                            is_owned=ev.owning))
        ev.outset[reference.number] = ev.heap[reference]
    return ev.live[id(value)]


@operation
def member(ev: Evaluator, value: Enum) -> Value:
    """A member of an enumeration, of which there is one."""
    if isinstance(value, (int, str)):
        return constant(value.value)
    ev.held.append(value)
    return ObjectValue(value, ("member", id(value)))


def _class(ev: Evaluator, value: type, name: str, node: AST, f: Frame) -> Value:
    if value.__module__ in ("builtins", "numpy", "math"):
        return LibraryValue(f"{value.__module__}.{value.__name__}")
    return class_value(value)


@operation
def live_function(ev: Evaluator, value: Any, node: AST, f: Frame, owner: ClassValue | None = None) -> Value:
    """A live function of the user's, with its text; of what has a derivative of its own only its name."""
    if isinstance(value, types.MethodType):
        return _method(ev, value, value.__name__, node, f)
    meaning = live_meaning(getattr(value, "__name__", "function"), value)
    if isinstance(meaning, Library):
        return LibraryValue(meaning.path)
    function = named_function(value)
    if function is None:
        raise ev.refusal(node, f"'{getattr(value, '__name__', value)}' is not a function that can be read")
    return FunctionValue(load(ev, function), ("live", id(function)), None, owner, handle=function)


def load(ev: Evaluator, function: Any) -> Captured:
    """The definition of a function, whose places are in the source of the whole."""
    if id(function) not in ev.loaded:
        captured = captured_of(function)
        ev.held.append(function)
        ev.loaded[id(function)] = replace(captured, tree=placed(ev, captured.source, captured.tree))
    return ev.loaded[id(function)]


def placed(ev: Evaluator, source: Source, definition: Any) -> Any:
    """A part of a text with its places in the source of the whole."""
    ev.source, added = ev.source.holding(source)
    if not added:
        return definition
    definition = tree.copy(definition)
    for n in tree.walk(definition):
        for place in ("lineno", "end_lineno"):
            if getattr(n, place, None) is not None:
                setattr(n, place, getattr(n, place) + added)
    return definition


@operation
def default_of(ev: Evaluator, function: FunctionValue, name: str, node: AST, f: Frame) -> Value | None:
    """The default of a parameter of a function that was defined outside."""
    handle = function.handle
    if handle is None:
        return None
    if not isinstance(handle, types.FunctionType):
        return ev.file_default(function, name, node)
    value = default_values(handle).get(name, ABSENT)
    if value is ABSENT:
        return None
    return constant(value) if type(value) in (int, float, bool) else outside_value(ev, name, value, node, f)
