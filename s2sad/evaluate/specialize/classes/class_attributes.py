"""Attributes of classes that the kernel assigns, as counters are: the run has its own, which begins with what is there.

    Body.count += 1         count_2 = count + 1
    self.id = Body.count    id = count_2
"""
from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.signals import Reached
from s2sad.evaluate.specialize.values import NONE, ClassValue, Value
from s2sad.live_objects.guards import ABSENT, taken
from s2sad.tree import AST


@dataclass(frozen=True)
class AssignedAttribute:
    """An attribute of a class that the kernel assigns somewhere."""
    made: type
    name: str


@operation
def assign_class_attribute(ev: Evaluator, made: ClassValue, name: str, value: Value, node: AST) -> None:
    """`Class.name = value`; what is there before the run is found when the evaluation begins anew."""
    if not isinstance(made.live, type) or issubclass(made.live, Enum) or (
            type(made.live).__setattr__ is not type.__setattr__):
        raise ev.refusal(node, "an attribute of a class or a module is assigned",
                         help="keep it in an object that the kernel is given")
    if AssignedAttribute(made.live, name) not in ev.assigned_attributes:
        raise Reached(made.name, AssignedAttribute(made.live, name), True)
    ev.assign_slot(ev.assigned_classes[made.live], name, value, f"{made.name}_{name}", node)


@operation
def class_attribute_begins(ev: Evaluator, attribute: AssignedAttribute, node: AST, f: Frame) -> Value:
    """What the attribute is before the run. Functions that read it are evaluated where they are called."""
    ev.inlines = True
    made = attribute.made
    if made not in ev.assigned_classes:
        ev.assigned_classes[made] = ev.heap.new(Object("record", label=made.__name__))
    holder, there = ev.assigned_classes[made], taken(made, "own", attribute.name)
    ev.assigned_attributes.add(attribute)
    if there is not ABSENT:
        label = f"{made.__name__}_{attribute.name}"
        ev.assign_slot(holder, attribute.name, ev.outside_value(label, there, node, f), label, node)
    ev.outset[holder.number] = ev.heap[holder]
    return NONE
