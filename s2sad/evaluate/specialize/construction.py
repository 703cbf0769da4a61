"""Objects that are made: constructors, dataclasses, named tuples, enumerations.
"""
from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from enum import Enum

from s2sad.evaluate.specialize.evaluator import Evaluator, Frame, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import ClassValue, Reference, TupleValue, Value
from s2sad.live_objects.guards import taken
from s2sad.tree import AST


# -- construction ----------------------------------------------------------------------------------------------------
@operation
def constructed(ev: Evaluator, made: ClassValue, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
                f: Frame) -> Value:
    """What calling a class gives."""
    live = made.live
    if isinstance(live, type) and issubclass(live, Enum):
        return _enum_member(ev, made, args, node)
    if isinstance(live, type) and issubclass(live, tuple):
        return _named_tuple(ev, made, args, keywords, node, f)
    if isinstance(live, type) and type(live).__call__ is not type.__call__ and type(live).__module__ != "abc":
        raise ev.refusal(node, f"'{made.name}' is made by a class of its own: {type(live).__name__}")
    if isinstance(live, type) and any(c.__module__ != "builtins" and c.__flags__ & (1 << 9) == 0 for c in live.__mro__):
        raise ev.refusal(node, f"'{made.name}' is not written in Python")
    if isinstance(live, type) and issubclass(live, (list, dict, set, str, int, float, BaseException)):
        raise ev.refusal(node, f"'{made.name}' is made of a class of Python's own", help="hold one in an attribute")
    if ev.class_item(made, "__new__", node, f) is not None:
        raise ev.refusal(node, f"'{made.name}' has a __new__ of its own")
    reference = ev.heap.new(Object("record", {}, made, label=ev.label, site=node))
    init = ev.method_named(made, "__init__", reference, node, f)
    ev.heap.put(Reference(f.reference.number), f".made{reference.number}", reference)
    if init is not None:
        ev.call(init, args, keywords, node, f)
    elif _is_dataclass(ev, made):
        _fill(ev, made, reference, args, keywords, node, f)
    elif args or keywords:
        raise ev.refusal(node, f"'{made.name}' takes no arguments")
    items = dict(ev.heap[f.reference].items)
    items.pop(f".made{reference.number}", None)
    ev.heap.set_items(f.reference, items)
    return reference


def _enum_member(ev: Evaluator, made: ClassValue, args: Sequence[Value], node: AST) -> Value:
    known = ev.known(args[0], node, "the value of a member of an enumeration")
    return ev.member(made.live(known))


def _named_tuple(ev: Evaluator, made: ClassValue, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
                 f: Frame) -> Value:
    fields = taken(made.live, "attribute", "_fields")
    defaults = taken(made.live, "attribute", "_field_defaults")
    given = {**dict(zip(fields, args)), **keywords}
    items = []
    for k in fields:
        if k not in given and k not in defaults:
            raise ev.refusal(node, f"'{made.name}' is not given '{k}'")
        items.append(ev.atoms(given[k] if k in given else ev.outside_value(k, defaults[k], node, f), k, node))
    if len(args) > len(fields) or any(k not in fields for k in keywords):
        raise ev.refusal(node, f"'{made.name}' has the fields {', '.join(fields)}")
    return TupleValue(tuple(items), made)


@operation
def compares_fields(ev: Evaluator, value: Value) -> bool:
    """Whether an object is of a dataclass whose `==` compares fields."""
    made = ev.class_of(value)
    live = made.live if made is not None and isinstance(value, Reference) else None
    return bool(getattr(getattr(live, "__dataclass_params__", None), "eq", False))


@operation
def compared_fields(ev: Evaluator, value: Value, node: AST, f: Frame) -> tuple[Value, ...]:
    """What `==` of a dataclass compares."""
    made = ev.class_of(value)
    assert made is not None
    return tuple(ev.attribute_of(value, d.name, node, f) for d in dataclasses.fields(made.live) if d.compare)


def _is_dataclass(ev: Evaluator, made: ClassValue) -> bool:
    return made.live is not None and dataclasses.is_dataclass(made.live)


def _fill(ev: Evaluator, made: ClassValue, reference: Reference, args: Sequence[Value], keywords: Mapping[str, Value],
          node: AST, f: Frame) -> None:
    """The fields of a dataclass, in order."""
    fields = dataclasses.fields(made.live)
    names = [d.name for d in fields if d.init and not d.kw_only]
    known = {d.name for d in fields if d.init}
    if len(args) > len(names) or not {*keywords} <= known:
        raise ev.refusal(node, f"'{made.name}' has the fields {', '.join(names)}")
    given = {**dict(zip(names, args)), **keywords}
    for d in fields:
        if d.name in given:
            value = given[d.name]
        elif d.default is not dataclasses.MISSING:
            value = ev.outside_value(d.name, d.default, node, f)
        elif d.default_factory is not dataclasses.MISSING:
            value = ev.call(ev.outside_value(d.name, d.default_factory, node, f), [], {}, node, f)
        elif d.init:
            raise ev.refusal(node, f"'{made.name}' is not given '{d.name}'")
        else:
            continue
        label = ev.heap[reference].label
        ev.assign_slot(reference, d.name, value, f"{label}_{d.name}" if label else d.name, node)
    after = ev.method_named(made, "__post_init__", reference, node, f)
    if after is not None:
        ev.call(after, [], {}, node, f)
