"""Attributes: read and assigned, as Python finds them.
"""
from __future__ import annotations

import dataclasses
from collections import Counter, OrderedDict, defaultdict, deque
from enum import Enum
from typing import Any

import numpy as np

from s2sad import tree
from s2sad.evaluate.specialize.classes.enumerations import known_attribute
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    UNKNOWN, WITH_NONE, ClassValue, Data, FunctionValue, Iteration, LibraryValue, MethodValue, ObjectValue, OpaqueValue,
    Reference, ResidualObject, ScopeValue, SliceValue, SuperValue, TupleValue, Value, constant,
)
from s2sad.live_objects.guards import ABSENT, taken
from s2sad.tree import AST

_CONTAINERS: dict[str, tuple[type, ...]] = {
    "list": (list, deque), "dict": (dict, Counter, OrderedDict, defaultdict), "set": (set, frozenset)}

_NUMBERS = (np.ndarray, np.float64, int, complex)


def _has(kind: type, name: str) -> bool:
    """Whether an object of a type has an attribute: what the type itself has as an object does not count."""
    return any(name in vars(c) for c in kind.__mro__)


@operation
def attribute_of(ev: Evaluator, base: Value, name: str, node: AST, f: Frame) -> Value:
    """`base.name`."""
    if isinstance(base, Data):
        return _of_data(ev, base, name, node)
    if isinstance(base, Reference):
        held = ev.heap[base]
        if held.kind == "record":
            return _of_object(ev, base, held, name, node, f)
        if is_sparse(base, ev.heap):
            return ev.matrix_attribute(base, name, node, f)
        if not any(_has(made, name) for made in _CONTAINERS.get(held.kind, (object,))):
            said = ev.subject(base, node)
            of_arrays = _has(np.ndarray, name) and said.startswith("'")
            help = f"pass numpy.array({said[1:-1]}, dtype=float)" if of_arrays else ""
            raise ev.refusal(node, f"{said}, {ev.kind_of(base)}, has no attribute '{name}' here", help, "S203")
        return constant(held.most) if name == "maxlen" else _method(ev, base, name, _CONTAINERS[held.kind], node)
    if isinstance(base, ResidualObject):
        return _of_row(ev, base, name, node, f)
    if isinstance(base, TupleValue):
        return _of_tuple(ev, base, name, node, f)
    if isinstance(base, ClassValue):
        return _of_class(ev, base, name, node, f)
    if isinstance(base, SuperValue):
        return _of_super(ev, base, name, node, f)
    if isinstance(base, ScopeValue):
        if base.scope.lookup(name) is None:
            raise ev.refusal(node, f"'{base.name}' has no '{name}'", code="S202")
        return ev.scope_value(base.scope, name, node, f)
    if isinstance(base, LibraryValue):
        return _of_library(ev, base, name, node)
    if isinstance(base, ObjectValue):
        return known_attribute(ev, base, name, node, f)
    if ev.is_attribute_dictionary(base):
        return MethodValue(base, name)
    if isinstance(base, FunctionValue) and name in ("__name__", "__doc__"):
        return constant(base.captured.name if name == "__name__" else "")
    if isinstance(base, Iteration):
        return MethodValue(base, name)
    if isinstance(base, OpaqueValue) and base.what == WITH_NONE and name == "T":
        return base
    if isinstance(base, SliceValue) and name in ("start", "stop", "step"):
        return base.parts[("start", "stop", "step").index(name)]
    raise ev.refusal(node, f"an attribute of {ev.kind_of(base)}")


def _of_data(ev: Evaluator, base: Data, name: str, node: AST) -> Value:
    if base.is_known and base.known is None:
        raise ev.none_here(base, node)
    if isinstance(base.known, str):
        return MethodValue(base, name)
    made = tree.at(tree.attribute(ev.spelled(base, node), name), node)
    if name in ("shape", "size", "ndim"):
        shape = ev.shape_of(base)
        size = 1
        for n in shape.known if shape.is_known else ():
            size *= n
        known = {"shape": shape.known, "size": size, "ndim": len(shape.known)}[name] if shape.is_known else UNKNOWN
        if base.shape is not None and name != "size":
            rank = len(base.shape)
            return Data(made, known, shape.demands, count=rank) if name == "shape" else Data(made, rank)
        return Data(made, known, shape.demands, shape=None if name == "shape" else ())
    if name == "T":
        whole = base.shape
        return Data(made, shape=None if whole is None else whole[::-1], origins=base.origins)
    if name in ("real", "imag", "dtype", "itemsize", "nbytes", "value", "mT") or _is_of_type(base.node):
        return Data(made)
    most = base.rows.known.most if base.is_list and base.rows is not None else -1
    if name == "maxlen" and (most is None or most >= 0):
        return constant(most)
    return _method(ev, base, name, _CONTAINERS["list"] if base.is_list else _NUMBERS, node)


def _method(ev: Evaluator, base: Value, name: str, kinds: tuple[type, ...], node: AST) -> MethodValue:
    """A method of what is of one of some types; refuses what is data there."""
    there = [getattr(kind, name) for kind in kinds if _has(kind, name)]
    if there and name != "flat" and not any(map(callable, there)):
        raise ev.refusal(node, f"the attribute .{name} is not supported in a kernel",
                         help="read it outside, and give it to the kernel as an argument")
    return MethodValue(base, name)


@operation
def refuse_missing(ev: Evaluator, value: Value, node: AST) -> None:
    """Refuses what is compared or tested and is an attribute that no number and no array has."""
    base = value.base if isinstance(value, MethodValue) else None
    if isinstance(value, MethodValue) and isinstance(base, Data):
        kinds = (str,) if isinstance(base.known, str) else _CONTAINERS["list"] if base.is_list else _NUMBERS
        if not any(_has(kind, value.name) for kind in kinds):
            what = {str: "text", list: "list"}.get(kinds[0], "number and no array")
            raise ev.refusal(node, f"no {what} has an attribute .{value.name}",
                             help="ask for what there is, as .shape, .ndim and .size of an array")


def _is_of_type(node: AST) -> bool:
    """Whether a call gives what a type is like: `np.finfo(float)`."""
    return tree.call_name(node) in ("numpy.finfo", "numpy.iinfo")


def _of_row(ev: Evaluator, base: ResidualObject, name: str, node: AST, f: Frame) -> Value:
    """What an object of a table has under a name: what its class says, or what the table holds."""
    table = base.table
    if table.kind != "record":
        return _method(ev, base, name, _CONTAINERS[table.kind], node)
    held = Object("record", {k: constant(None) for k in table.columns}, table.made, label=table.made.name.lower())
    found = _of_object(ev, base, held, name, node, f)
    return ev.residual_item(base, name, node) if found is held.items.get(name) else found


def _of_object(ev: Evaluator, base: Reference | ResidualObject, held: Object, name: str, node: AST, f: Frame) -> Value:
    if name == "__class__" and held.made is not None:
        return held.made
    if ev.class_item(held.made, "__getattribute__", node, f) is not None:
        raise ev.refusal(node, "an attribute is read, and the class says how: '__getattribute__'",
                         help="write what it does")
    found = ev.class_item(held.made, name, node, f) if name != "__dict__" else None
    data = found is not None and isinstance(found[1], LibraryValue) and found[1].path == "builtins.property"
    if not data and name in held.items:
        return held.items[name]
    if not data and held.live is not None and isinstance(base, Reference):
        own = taken(held.live, "own", name)
        slots = [taken(c.live, "own", "__slots__") for c in ev.mro(held.made)]
        if own is ABSENT and any(name in s for s in slots if s is not ABSENT):
            own = taken(held.live, "attribute", name)
        if own is not ABSENT:
            owning, ev.owning = ev.owning, held.is_owned
            value = ev.outside_value(f"{held.label}_{name}", own, node, f)
            ev.owning = owning
            ev.heap.put(base, name, value)
            ev.note_outside(base, name, value)
            return value
    if found is not None:
        if isinstance(found[1], LibraryValue) and found[1].path == "functools.cached_property":
            if not isinstance(base, Reference):
                raise ev.refusal(node, "a property that is computed once, of an object of which only the run knows "
                                 "which it is", help="write it as a property")
            value = ev.call(found[1].first[0], [base], {}, node, f)
            ev.assign_slot(base, name, value, f"{held.label}_{name}" if held.label else name, node)
            return ev.heap[base].items[name]
        return ev.bound(found[1], base, held.made, node, f)
    if name == "__dict__":
        return ev.attribute_dictionary(base, node)
    fallback = ev.class_item(held.made, "__getattr__", node, f)
    if fallback is not None:
        return ev.call(ev.bound(fallback[1], base, held.made, node, f), [constant(name)], {}, node, f)
    ev.throws(AttributeError, node)
    if held.made is None:
        raise ev.refusal(node, f"'{held.path or held.label}' has no attribute '{name}' here",
                         help="if it is of a class, annotate it with that, or name it, as in --types \"a: Grid{...}\"")
    if held.live is not None:
        raise ev.missing(node, held.label, f".{name}", [f".{n}" for n in dir(held.live)])
    named, kind = ev.subject(base, node), ev.kind_of(base)
    there = ", ".join(map(str, held.items))
    raise ev.refusal(node, f"{named}{'' if named == kind else f', {kind},'} has no attribute '{name}' here",
                     f"it has {there}" if there else "", "S202")


@operation
def has_attribute(ev: Evaluator, base: Value, name: str, node: AST, f: Frame) -> bool:
    """`hasattr(base, name)`."""
    if isinstance(base, Reference) and ev.heap[base].kind == "record":
        held = ev.heap[base]
        own = held.live is not None and taken(held.live, "own", name) is not ABSENT
        return own or name in held.items or ev.class_item(held.made, name, node, f) is not None
    if isinstance(base, ResidualObject) and base.table.kind != "record":
        return any(_has(kind, name) for kind in _CONTAINERS[base.table.kind][:1])
    if isinstance(base, Data) and base.is_list:
        return _has(list, name) or base.rows is not None and base.rows.known.most is not None and _has(deque, name)
    if isinstance(base, ResidualObject):
        return name in base.table.columns or ev.class_item(base.table.made, name, node, f) is not None
    if isinstance(base, Data) and not base.is_known:
        numbers = (float, np.float64)
        kinds = (np.ndarray,) if base.shape else numbers if base.shape == () else (np.ndarray, *numbers)
        found = {_has(kind, name) for kind in kinds}
        if len(found) > 1:      # it depends on what it is, or on whose number it is
            raise ev.unknown(node, f"whether this has '{name}' must be known before the run", base,
                             help="test it with isinstance")
        return found.pop()
    if isinstance(base, TupleValue) and base.made is not None:
        return name in ev.layout_of(base.made).names or _has(tuple, name) or (
            ev.class_item(base.made, name, node, f) is not None)
    if isinstance(base, ClassValue):
        return ev.class_item(base, name, node, f) is not None
    if isinstance(base, ScopeValue):
        return base.scope.lookup(name) is not None
    raise ev.refusal(node, "hasattr of this is not supported in a kernel")


def _of_tuple(ev: Evaluator, base: TupleValue, name: str, node: AST, f: Frame) -> Value:
    if base.made is not None:
        fields = ev.layout_of(base.made).names
        if name in fields:
            return base.items[fields.index(name)]
        found = ev.class_item(base.made, name, node, f)
        if found is not None and not (isinstance(found[1], FunctionValue) and name.startswith("_")):
            return ev.bound(found[1], base, base.made, node, f)
    return MethodValue(base, name)


@operation
def tuple_method(ev: Evaluator, base: TupleValue, name: str, args: list[Value], keywords: dict[str, Value], node: AST,
                 f: Frame) -> Value:
    if name in ("index", "count"):
        return ev.list_method(ev.list_of(base.items, node), name, args, node)  # pyright: ignore
    fields = ev.layout_of(base.made).names if base.made is not None else ()
    if name == "_replace":
        return dataclasses.replace(base, items=tuple(keywords.get(k, v) for k, v in zip(fields, base.items)))
    if name == "_asdict":
        return ev.new_dict(dict(zip(fields, base.items)), node)
    said = f".{name} of {ev.subject(base, node)}, which is {ev.kind_of(base)},"
    raise ev.refusal(node, f"{said} is not supported in a kernel",
                     help="write what it does with the items")


def _of_class(ev: Evaluator, base: ClassValue, name: str, node: AST, f: Frame) -> Value:
    if name == "__name__":
        return constant(base.name)
    if isinstance(base.live, type) and issubclass(base.live, Enum):
        found = taken(base.live, "attribute", name)
        if isinstance(found, base.live):
            return ev.member(found)
    layout = ev.layout_of(base) if name == "_make" else None
    if layout is not None and layout.kind == "named":
        return MethodValue(base, name)
    found = ev.class_item(base, name, node, f)
    if found is None:
        raise ev.refusal(node, f"the class '{base.name}' has no attribute '{name}'")
    return ev.bound(found[1], None, base, node, f)


def _of_super(ev: Evaluator, base: SuperValue, name: str, node: AST, f: Frame) -> Value:
    made = base.instance if isinstance(base.instance, ClassValue) else ev.class_of(base.instance)
    classes = ev.mro(made) if made is not None else []
    after = classes[classes.index(base.after) + 1:] if base.after in classes else []
    instance = None if isinstance(base.instance, ClassValue) else base.instance
    for c in after:
        alone = dataclasses.replace(c)
        found = _own_item(ev, alone, name, node, f)
        if found is not None:
            return ev.bound(found, instance, made, node, f)
    if name in ("__init__", "__init_subclass__"):
        return LibraryValue("builtins.object.__init__")
    raise ev.refusal(node, f"super() has no '{name}'")


def _own_item(ev: Evaluator, made: ClassValue, name: str, node: AST, f: Frame) -> Value | None:
    found = ev.class_item(made, name, node, f)
    return found[1] if found is not None and found[0] == made else None


def _of_library(ev: Evaluator, base: LibraryValue, name: str, node: AST) -> Value:
    if base.path == "builtins.property" and base.first and name in ("getter", "setter", "deleter"):
        return LibraryValue(f"builtins.property.{name}", base.first)
    if base.path.startswith("builtins.") and name == "__name__":
        return constant(base.path.rpartition(".")[2])
    return ev.library_member(base.path, name, node)


@operation
def is_held_plainly(ev: Evaluator, base: ResidualObject, key: Any, node: AST, f: Frame) -> bool:
    """Whether nothing of the user's says how an attribute or an item is assigned."""
    made = base.table.made
    if made is None or not isinstance(key, str):
        return base.table.kind != "record"
    layout = ev.layout_of(made)
    said = any(ev.class_item(made, name, node, f) is not None for name in ("__setattr__", key))
    return not said and (layout is None or not layout.is_frozen)


# -- assignment ------------------------------------------------------------------------------------------------------
@operation
def assign_attribute(ev: Evaluator, base: Reference | ResidualObject, name: str, value: Value, node: AST, f: Frame
                     ) -> None:
    """`base.name = value`."""
    held = ev.change(base, node) if isinstance(base, Reference) else Object(base.table.kind, made=base.table.made)
    if held.kind != "record":
        raise ev.refusal(node, f"an attribute of {ev.kind_of(base)} is assigned", help="write into its entries: "
                         "A.data[:] = ..., or build another matrix" if is_sparse(base, ev.heap) else "")
    found = ev.class_item(held.made, name, node, f)
    if found is not None and isinstance(found[1], LibraryValue) and found[1].path == "builtins.property":
        if len(found[1].first) < 2:
            raise ev.refusal(node, f"the property '{name}' is assigned, which has no setter")
        ev.call(found[1].first[1], [base, value], {}, node, f)
        return
    if found is not None and isinstance(found[1], ObjectValue) and hasattr(type(found[1].value), "__set__"):
        raise ev.refusal(node, "a descriptor is assigned", help="write it as a property with a setter")
    if ev.class_item(held.made, "__setattr__", node, f) is not None:
        raise ev.refusal(node, "an attribute is assigned, and the class says how: '__setattr__'",
                         help="write what it does")
    layout = ev.layout_of(held.made)
    if layout is not None and layout.is_frozen:
        raise ev.refusal(node, f"an attribute of an object of class {held.made.name if held.made else '?'} is "
                         "assigned, which is frozen")
    if not isinstance(base, Reference):
        ev.store_residual(base, name, value, node, f)
        return
    label = f"{held.label}_{name}" if held.label else name
    if isinstance(value, Reference) and not ev.heap[value].label:
        ev.heap.objects[value.number] = dataclasses.replace(ev.heap[value], label=label)
    ev.assign_slot(base, name, value, label, node)
