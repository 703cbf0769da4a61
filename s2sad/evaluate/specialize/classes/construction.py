"""Objects that are made: constructors, dataclasses, named tuples, enumerations.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
from types import SimpleNamespace

from s2sad.evaluate.specialize.classes.class_layout import Layout
from s2sad.evaluate.specialize.classes.enumerations import member_by_value
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.values import ClassValue, Reference, ResidualObject, TupleValue, Value
from s2sad.tree import AST


# -- construction ----------------------------------------------------------------------------------------------------
@operation
def constructed(ev: Evaluator, made: ClassValue, args: Sequence[Value], keywords: Mapping[str, Value], node: AST,
                f: Frame) -> Value:
    """What calling a class gives."""
    live = made.live
    if isinstance(live, type) and issubclass(live, Enum):
        return member_by_value(ev, live, ev.known(args[0], node, "the value of a member of an enumeration"))
    if live is SimpleNamespace:
        reference = ev.heap.new(Object("record", {}, made, label=ev.label, site=node))
        for name, value in keywords.items():
            ev.assign_slot(reference, name, value, f"{ev.heap[reference].label}_{name}".lstrip("_"), node)
        return ev.as_residual(reference, node)
    layout = ev.layout_of(made)
    if layout is not None and layout.kind == "named":
        return _named_tuple(ev, made, layout, args, keywords, node, f)
    if isinstance(live, type) and type(live).__call__ is not type.__call__ and type(live).__module__ != "abc":
        raise ev.refusal(node, f"'{made.name}' is made by a class of its own: {type(live).__name__}")
    if isinstance(live, type) and any(c.__module__ != "builtins" and c.__flags__ & (1 << 9) == 0 for c in live.__mro__):
        raise ev.refusal(node, f"'{made.name}' is not written in Python")
    if isinstance(live, type) and issubclass(live, (list, dict, set, str, int, float, BaseException)):
        raise ev.refusal(node, f"'{made.name}' is made of a class of Python's own", help="hold one in an attribute")
    if ev.class_item(made, "__new__", node, f) is not None:
        raise ev.refusal(node, f"'{made.name}' has a __new__ of its own")
    reference = ev.heap.new(Object("record", {}, made, label=ev.label, site=node))
    init = None if _is_filled(ev, made, node, f) else ev.method_named(made, "__init__", reference, node, f)
    ev.heap.put(Reference(f.reference.number), f".made{reference.number}", reference)
    if init is not None:
        ev.call(init, args, keywords, node, f)
    elif layout is not None:
        _fill(ev, made, layout, reference, args, keywords, node, f)
    elif args or keywords:
        raise ev.refusal(node, f"'{made.name}' takes no arguments")
    items = dict(ev.heap[f.reference].items)
    items.pop(f".made{reference.number}", None)
    ev.heap.set_items(f.reference, items)
    return ev.as_residual(reference, node)


def _named_tuple(ev: Evaluator, made: ClassValue, layout: Layout, args: Sequence[Value], keywords: Mapping[str, Value],
                 node: AST, f: Frame) -> Value:
    given = {**dict(zip(layout.names, args)), **keywords}
    items = []
    for d in layout.fields:
        if d.name not in given and d.default is None:
            raise ev.refusal(node, f"'{made.name}' is not given '{d.name}'")
        items.append(ev.atoms(given[d.name] if d.default is None or d.name in given else d.default(node, f), d.name,
                              node))
    if len(args) > len(items) or any(k not in layout.names for k in keywords):
        raise ev.refusal(node, f"'{made.name}' has the fields {', '.join(layout.names)}")
    return TupleValue(tuple(items), made)


@operation
def compares_fields(ev: Evaluator, value: Value) -> bool:
    """Whether an object is of a dataclass whose `==` compares fields."""
    layout = ev.layout_of(ev.class_of(value)) if isinstance(value, (Reference, ResidualObject)) else None
    return layout is not None and layout.is_equal


@operation
def compared_fields(ev: Evaluator, value: Value, node: AST, f: Frame) -> tuple[Value, ...]:
    """What `==` of a dataclass compares."""
    return tuple(ev.attribute_of(value, d.name, node, f) for d in ev.layout_of(ev.class_of(value)).fields
                 if d.is_compared)


def _is_filled(ev: Evaluator, made: ClassValue, node: AST, f: Frame) -> bool:
    """Whether an object's fields are filled as a dataclass does it: no class in front of it has an `__init__`."""
    classes = ev.mro(made)
    first = next((k for k, c in enumerate(classes) if ev.declares_layout(c)), len(classes))
    own = ev.class_item(made, "__init__", node, f)
    return first < len(classes) and (own is None or classes.index(own[0]) > first)


def _fill(ev: Evaluator, made: ClassValue, layout: Layout, reference: Reference, args: Sequence[Value],
          keywords: Mapping[str, Value], node: AST, f: Frame) -> None:
    """The fields of a dataclass, in order."""
    names = [d.name for d in layout.fields if d.is_given and not d.by_name]
    known = {d.name for d in layout.fields if d.is_given}
    if len(args) > len(names) or not {*keywords} <= known:
        raise ev.refusal(node, f"'{made.name}' has the fields {', '.join(names)}")
    given = {**dict(zip(names, args)), **keywords}
    for d in layout.fields:
        if d.name in given:
            value = given[d.name]
        elif d.default is not None:
            value = d.default(node, f)
        elif d.is_given:
            raise ev.refusal(node, f"'{made.name}' is not given '{d.name}'")
        else:
            continue
        label = ev.heap[reference].label
        ev.assign_slot(reference, d.name, value, f"{label}_{d.name}" if label else d.name, node)
    after = ev.method_named(made, "__post_init__", reference, node, f)
    if after is not None:
        ev.call(after, [], {}, node, f)
