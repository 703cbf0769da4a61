"""Where classes have their names: the order of classes, methods, properties.
"""
from __future__ import annotations

import dataclasses
import functools
import sys
import types
from typing import Any

from s2sad.evaluate.library import WRITTEN
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.sequences.listed_records import ONE_OF_SEVERAL
from s2sad.evaluate.specialize.values import (
    ClassValue, Data, FunctionValue, LibraryValue, ObjectValue, Reference, ResidualObject, TupleValue, Value,
)
from s2sad.live_objects.code_text import is_generated
from s2sad.live_objects.guards import ABSENT, reached, taken
from s2sad.tree import AST

_OBJECT = ("__init__", "__new__", "__setattr__", "__getattribute__", "__eq__", "__ne__", "__hash__", "__repr__",
           "__str__", "__init_subclass__", "__class_getitem__")


NONE_TYPE = "types.NoneType"
_NO_NUMBERS = ("builtins.str", "builtins.list", "builtins.tuple", "builtins.dict", "collections.deque", "builtins.set")
_SEQUENCES = ("builtins.list", "collections.deque", "builtins.tuple")
_INTEGERS = ("builtins.int", "builtins.bool")
_PYTHONS = {"builtins.float": "float64", "builtins.complex": "complex128"}
_OF_NUMBERS = (int, float, complex, str)      # classes of the user's may be made of these, and arguments of them


@operation
def class_of(ev: Evaluator, value: Value) -> ClassValue | None:
    """The class of the user's that an object or a named tuple is of."""
    if isinstance(value, Reference):
        return ev.heap[value].made
    if isinstance(value, ResidualObject):
        return value.table.made
    return value.made if isinstance(value, TupleValue) else None


@operation
def mro(ev: Evaluator, made: ClassValue) -> list[ClassValue]:
    """The classes in which a name is looked up, in order."""
    if made.live is not None:
        return [class_value(c) for c in taken(made.live, "mro") if c is not object]
    rows = [mro(ev, b) for b in made.bases] + [list(made.bases)]
    found = [made]
    while rows := [r for r in rows if r]:
        head = next((r[0] for r in rows if not any(r[0] in other[1:] for other in rows)), None)
        if head is None:
            break
        found.append(head)
        rows = [[c for c in r if c != head] for r in rows]
    return found


@operation
def class_item(ev: Evaluator, made: ClassValue | None, name: str, node: AST, f: Frame
               ) -> tuple[ClassValue, Value] | None:
    """What a class has under a name, with the class that has it."""
    for c in mro(ev, made) if made is not None else ():
        if c.live is None:
            items = ev.heap.objects[c.number].items
            if name in items:
                return c, items[name]
            continue
        own = ev.assigned_classes.get(c.live)
        if own is not None and name in ev.heap[own].items:
            return c, ev.heap[own].items[name]
        found = taken(c.live, "own", name)
        if isinstance(found, types.MemberDescriptorType):
            continue        # a slot: what lies in the object
        if _computes(found):
            raise ev.refusal(node, f"'{name}' of class {c.name} is a descriptor of class {type(found).__name__}",
                             help="write it as a property")
        if found is not ABSENT and not (c.live.__module__ == "builtins" or name in _OBJECT and _is_generated(found)):
            return c, _descriptor(ev, c, name, found, node, f) or ev.outside_value(f"{c.name}_{name}", found, node, f)
    return None


def _computes(found: Any) -> bool:
    """Whether an item of a class is an object of a class of the user's that is asked when it is read or assigned."""
    kinds = type(found).__mro__
    home = kinds[0].__module__.partition(".")[0]
    return home not in ("builtins", "functools", "types", "numba", "s2sad", "abc", "enum") and any(
        n in vars(c) for c in kinds for n in ("__get__", "__set__"))


def _is_generated(found: Any) -> bool:
    """Whether a function is one that dataclasses and named tuples make."""
    code = getattr(found, "__code__", None)
    return code is None or is_generated(code) or "dataclasses" in code.co_filename


def _descriptor(ev: Evaluator, owner: ClassValue, name: str, found: Any, node: AST, f: Frame) -> Value | None:
    """Functions of a class, and what property, staticmethod and classmethod make of them."""
    kinds = {property: ("builtins.property", "fget"), staticmethod: ("builtins.staticmethod", "__func__"),
             classmethod: ("builtins.classmethod", "__func__")}
    def part(attribute: str) -> Any:
        return reached(found, "part", attribute, getattr(found, attribute))
    for kind, (path, attribute) in kinds.items():
        if isinstance(found, kind):
            names = (attribute, "fset") if getattr(found, "fset", None) is not None else (attribute,)
            return LibraryValue(path, tuple(ev.live_function(part(n), node, f, owner) for n in names))
    if type(found).__name__ == "cached_property":
        return LibraryValue("functools.cached_property", (ev.live_function(part("func"), node, f, owner),))
    if type(found).__name__ == "partialmethod" and isinstance(found.func, types.FunctionType):
        keywords = part("keywords")
        given = (ev.outside_value(f"{owner.name}_{name}_{k}", a, node, f) for k, a in enumerate(part("args")))
        named = ((k, ev.outside_value(f"{owner.name}_{name}_{k}", taken(keywords, "item", k), node, f))
                 for k in taken(keywords, "keys"))
        inner = ev.live_function(part("func"), node, f, owner)
        return LibraryValue("functools.partialmethod", (inner, *given), (*named,))
    return ev.live_function(found, node, f, owner) if isinstance(found, types.FunctionType) else None


@operation
def method_named(ev: Evaluator, made: ClassValue | None, name: str, instance: Value, node: AST, f: Frame
                 ) -> Value | None:
    """A method of an object, bound to it; None where its class has none."""
    found = class_item(ev, made, name, node, f)
    return None if found is None else bound(ev, found[1], instance, made, node, f)


@operation
def special_method(ev: Evaluator, value: Value, name: str, node: AST, f: Frame) -> Value | None:
    """A method that the user's class of an object or a named tuple has under a name of Python's; None without one."""
    made = class_of(ev, value)
    return None if made is None else method_named(ev, made, name, value, node, f)


@operation
def is_sequence(ev: Evaluator, made: ClassValue | None, node: AST, f: Frame) -> bool:
    """Whether NumPy would take an object for the array of its items."""
    layout = ev.layout_of(made)
    if made is None or layout is not None and layout.kind == "named":
        return made is not None
    return all(class_item(ev, made, name, node, f) is not None for name in ("__len__", "__getitem__"))


@operation
def bound(ev: Evaluator, value: Value, instance: Value | None, made: ClassValue | None, node: AST, f: Frame) -> Value:
    """What a class's item is as an attribute of an object, or of the class where `instance` is None."""
    if isinstance(value, FunctionValue) and instance is not None:
        return dataclasses.replace(value, first=(instance, *value.first))
    if isinstance(value, LibraryValue) and value.first and value.path in (
            "builtins.property", "functools.cached_property", "functools.partialmethod", "builtins.staticmethod",
            "builtins.classmethod"):
        if value.path == "builtins.staticmethod":
            return value.first[0]
        if value.path == "builtins.classmethod":
            inner = value.first[0]
            assert isinstance(inner, FunctionValue) and made is not None
            return dataclasses.replace(inner, first=(made, *inner.first))
        if value.path == "functools.partialmethod":
            inner, *given = value.first
            if instance is None or not isinstance(inner, FunctionValue):
                raise ev.refusal(node, "a partialmethod that is no object's, or of what is no function of the class",
                                 help="write it as a method that calls the other one")
            return dataclasses.replace(inner, first=(instance, *inner.first, *given), keywords=tuple(
                {**dict(inner.keywords), **dict(value.keywords)}.items()))
        if instance is not None:
            return ev.call(value.first[0], [instance], {}, node, f)
    if isinstance(value, ObjectValue) and hasattr(type(value.value), "__get__"):
        raise ev.refusal(node, "a descriptor is read", help="write it as a property")
    return value


@operation
def is_instance(ev: Evaluator, value: Value, made: Value, node: AST) -> bool | None:
    """`isinstance(value, made)`; None where it is a matter of types of arrays and numbers."""
    if isinstance(made, TupleValue):
        found: bool | None = False
        for m in made.items:
            if one := is_instance(ev, value, m, node):
                return True
            found = None if one is None else found
        return found
    own = class_of(ev, value)
    if isinstance(made, ClassValue) and isinstance(value, Data) and made.live is not None:
        if not value.is_known and issubclass(made.live, _OF_NUMBERS):
            raise ev.unknown(node, "what an argument is must be known before the run", value)
        return value.is_known and isinstance(value.known, made.live)
    if isinstance(made, ClassValue):
        return own is not None and made in mro(ev, own) or (isinstance(value, ObjectValue) and made.live is not None
                                                           and isinstance(value.value, made.live))
    path = made.path if isinstance(made, LibraryValue) else ""
    most = value.rows.known.most if isinstance(value, Data) and value.rows is not None else None
    if isinstance(value, Data) and not value.is_known and path in _SEQUENCES and (
            most == ONE_OF_SEVERAL or not value.is_list and (value.count or value.may_be_row)):
        raise ev.unknown(node, "whether something is a list or a tuple is asked, which only the run knows", value)
    if isinstance(value, Data) and value.is_list:
        return path in ("builtins.object", _SEQUENCES[most is not None])
    if isinstance(value, Data):
        answer = _is_of_library(value, path)
        if answer is None and value.demands:
            raise ev.unknown(node, "what an argument is must be known before the run", value)
        return answer
    kinds = {"list": "builtins.list", "dict": "builtins.dict", "set": "builtins.set"}
    if isinstance(value, (Reference, ResidualObject)):
        return kinds.get(value.table.kind if isinstance(value, ResidualObject) else ev.heap[value].kind) == path
    if isinstance(value, TupleValue):
        return path == "builtins.tuple"
    return path == "builtins.object"


def _is_of_library(value: Data, path: str) -> bool | None:
    """Whether an array or a number is of a class of a library's; a float64 is a float, for NumPy's are, too."""
    if value.is_known:
        module, _, name = path.rpartition(".")
        kind = getattr(sys.modules.get(module), name, None)
        return isinstance(value.known, kind) if isinstance(kind, type) else None
    if path in (NONE_TYPE, *_NO_NUMBERS):
        return None if value.shape is None and value.demands else False
    if path == "numpy.ndarray":
        return None if value.shape is None else value.shape != ()
    if value.shape:
        return False
    if value.dtype in ("int64", "bool") and path in _INTEGERS or not value.dtype:
        return None         # Python's own and NumPy's are one type here
    return value.dtype == _PYTHONS[path] if path in _PYTHONS else False if path in _INTEGERS else None


@functools.cache
def class_value(made: type) -> ClassValue:
    return ClassValue(made.__name__, made)


def library_value_of(path: str) -> ClassValue | LibraryValue:
    """Something of a library; a class that is read in its place is that class, also where it is asked for."""
    made = WRITTEN.get(path)
    return class_value(made) if isinstance(made, type) else LibraryValue(path)
