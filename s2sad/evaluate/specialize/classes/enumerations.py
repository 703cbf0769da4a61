"""Enumerations from outside: their members, and what these have under a name."""
from __future__ import annotations

from enum import Enum, Flag
from types import FunctionType, MethodType
from typing import Any

from s2sad.evaluate.specialize.classes.class_lookup import class_value
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.values import ObjectValue, Value
from s2sad.live_objects.guards import ABSENT, class_attribute, reached, taken
from s2sad.tree import AST

_COMPUTED = (property, FunctionType, classmethod, staticmethod)


def all_members(ev: Evaluator, live: Any) -> list[Value]:
    """The members of an enumeration."""
    taken(live, "members")
    return [ev.member(m) for m in live]


def member_by_value(ev: Evaluator, live: Any, value: Any) -> Value:
    """The member that has a value."""
    taken(live, "members")
    return ev.member(live(value))


def combined(ev: Evaluator, made_of: Flag, value: Any) -> Value:
    """The member that an operator makes of one; which that is follows from all members: `~` is all the others."""
    made = taken(made_of, "class")
    taken(made, "members")
    return ev.member(reached(made, "combined", value.value, value))


def known_attribute(ev: Evaluator, base: ObjectValue, name: str, node: AST, f: Frame) -> Value:
    """An attribute of a member of an enumeration or another object that is known; what its class computes is evaluated,
    so that what that reads is a guard."""
    made = taken(base.value, "class")
    if isinstance(base.value, Enum) and isinstance(class_attribute(made, name), _COMPUTED):
        found = ev.class_item(class_value(made), name, node, f)
        assert found is not None
        return ev.bound(found[1], base, class_value(made), node, f)
    found = getattr(base.value, name, ABSENT)
    if found is ABSENT:
        raise ev.refusal(node, f"{base.value!r} has no '{name}'")
    stays = not isinstance(found, MethodType)       # a bound method is another object each time
    return ev.outside_value(name, taken(base.value, "attribute", name) if stays else found, node, f)
