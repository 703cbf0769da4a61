"""The dictionary of an object's attributes, `x.__dict__` or `vars(x)`: what is written there is an attribute.
"""
from __future__ import annotations

from collections.abc import Hashable, Mapping

from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.values import NONE, MethodValue, Reference, Value
from s2sad.tree import AST

_NAME = "__dict__"
_READING = ("get", "items", "keys", "values", "copy")


@operation
def attribute_dictionary(ev: Evaluator, base: Value, node: AST) -> MethodValue:
    """The dictionary of an object that the kernel makes."""
    held = ev.heap[base] if isinstance(base, Reference) else None
    if held is None or held.kind != "record" or held.live is not None:
        raise ev.refusal(node, "the dictionary of attributes of what is no object of the kernel's own",
                         help="name the attributes")
    return MethodValue(base, _NAME)


@operation
def is_attribute_dictionary(ev: Evaluator, value: Value) -> bool:
    return isinstance(value, MethodValue) and value.name == _NAME and isinstance(value.base, Reference)


@operation
def attributes_now(ev: Evaluator, value: MethodValue, node: AST) -> Reference:
    """A dictionary of what the attributes are now, which is read and let go."""
    return ev.new_dict(ev.heap[value.base].items, node)  # pyright: ignore[reportArgumentType]


@operation
def dictionary_method(ev: Evaluator, value: MethodValue, name: str, args: list[Value], keywords: dict[str, Value],
                      node: AST, f: Frame) -> Value:
    """The call of a method of the dictionary."""
    held = ev.heap[value.base]  # pyright: ignore[reportArgumentType]
    if name == "update":
        assign_attributes(ev, value, {**(ev.dict_items(args[0], node, f) if args else {}), **keywords}, node, f)
        return NONE
    if name == "setdefault":
        key = ev.key_of(args[0], node)
        if key not in held.items:
            assign_attributes(ev, value, {key: args[1] if args[1:] else NONE}, node, f)
        return ev.heap[value.base].items[key]  # pyright: ignore[reportArgumentType]
    if name not in _READING:
        raise ev.refusal(node, f".{name} of the dictionary of an object's attributes is not supported in a kernel",
                         help="name the attributes")
    return ev.container_method(attributes_now(ev, value, node), name, args, keywords, node, f)


@operation
def assign_attributes(ev: Evaluator, value: MethodValue, items: Mapping[Hashable, Value], node: AST, f: Frame) -> None:
    """Items of the dictionary are assigned: attributes, where the class does not say what assigning one does."""
    made = ev.class_of(value.base)
    for name, item in items.items():
        if not isinstance(name, str) or made is not None and (
                ev.class_item(made, name, node, f) is not None or ev.class_item(made, "__setattr__", node, f)):
            raise ev.refusal(node, f"the class has '{name}', or says what assigning it does, and it is assigned by the "
                             "dictionary of the object's attributes", help="assign the attribute")
        ev.assign_attribute(value.base, name, item, node, f)
