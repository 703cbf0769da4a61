"""Choices: a slot that holds different things on the ways that meet holds one of them, by a number.

    if c: hit = None           if c: which = 0
    else: hit = (t, s)         else: hit_0 = t; which = 1           `s` is an object, and stays the one that it is

Numbers and arrays share one alternative, as do structures of one make that nothing else holds; None, texts, functions
and shared objects are alternatives of their own.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.heap import Heap, Object
from s2sad.evaluate.specialize.values import (
    Choice, Conflict, Data, FunctionValue, LibraryValue, Reference, ResidualObject, TupleValue, Value, alike, constant,
    parts, with_parts,
)
from s2sad.tree import AST

Objects = Mapping[int, Object]


def are_functions(values: Sequence[Value]) -> bool:
    """Whether all are functions, or choices of them."""
    return all(isinstance(v, (FunctionValue, LibraryValue)) or isinstance(v, Choice) and are_functions(v.values)
               for v in values)


def is_number(value: Value) -> bool:
    """Whether a value is a number or an array of the residual program, or a number that is known."""
    return isinstance(value, Data) and not (value.is_known and (value.known is None or isinstance(value.known, str)))


def structure(heap: Heap, objects: Objects, value: Value) -> Any:
    """The make of a structure that nothing else holds, None of what is one alternative by itself."""
    if isinstance(value, ResidualObject):
        return value.table
    if isinstance(value, TupleValue):
        return ("tuple", value.made, len(value.items))
    held = objects.get(value.number) if isinstance(value, Reference) else None
    if held is None or held.kind in ("frame", "class") or held.path or held.live is not None or heap.holders(
            value, objects) > 1:  # pyright: ignore[reportArgumentType]
        return None
    return (held.kind, held.made, tuple(held.items))


@dataclass
class Alternative:
    """One of the things that a slot may hold: what it is on the ways that have it, with the ways' heaps, and the number
    that it has there."""
    held: list[tuple[int, Objects, Value]]
    numbers: list[int]


def maybe_unbound(value: Value, on_some: Callable[[str], bool] = lambda _: True) -> Value:
    """A value of which some ways do not bind some names."""
    if isinstance(value, (TupleValue, ResidualObject)):
        return with_parts(value, [maybe_unbound(v, on_some) for v in parts(value)])
    if isinstance(value, Choice):
        return replace(value, number=maybe_unbound(value.number, on_some),
                       values=tuple(maybe_unbound(v, on_some) for v in value.values))
    return replace(value, may_be_unbound=True) if isinstance(value, Data) and value.name and on_some(
        value.name) else value


def alternatives(heap: Heap, held: Sequence[tuple[Objects, Value]]) -> tuple[list[Alternative], list[dict[int, int]]]:
    """The different things among the values of ways, and for each way the places of its own, by their
    numbers."""
    found: list[Alternative] = []
    places: list[dict[int, int]] = []
    for k, (objects, value) in enumerate(held):
        places.append({})
        for j, one in zip(value.numbers, value.values) if isinstance(value, Choice) else ((0, value),):
            place = next((p for p, a in enumerate(found) if p not in places[k].values() and _is_one(
                heap, objects, one, a)), len(found))
            if place == len(found):
                found.append(Alternative([], []))
            found[place].held.append((k, objects, one))
            found[place].numbers.append(j)
            places[k][j] = place
    return found, places


def _is_one(heap: Heap, objects: Objects, value: Value, other: Alternative) -> bool:
    _, theirs, there = other.held[0]
    if is_number(value) or is_number(there):
        return is_number(value) and is_number(there)
    make = structure(heap, objects, value)
    return alike(value, there) or make is not None and make == structure(heap, theirs, there)


def is_chosen(value: Value, number: int, node: AST) -> AST | None:
    """The test whether a choice is the alternative with a number; None of what is no choice."""
    if not isinstance(value, Choice):
        return None
    return tree.at(tree.compare(tree.copy(value.number.node), tree.Eq(), tree.const(number)), node)


def number_of(value: Value, places: Mapping[int, int], node: AST) -> Data:
    """The number of the alternative that a value is, where its own have these places."""
    if not isinstance(value, Choice):
        return constant(places[0])
    if all(place == j for j, place in places.items()):
        return value.number
    *rest, last = sorted(places)
    spelled: Any = tree.const(places[last])
    for j in reversed(rest):
        spelled = tree.IfExp(is_chosen(value, j, node), tree.const(places[j]), spelled)
    return Data(tree.at(spelled, node))


def chosen_value(heap: Heap, held: Sequence[tuple[Objects, Value]], node: AST,
                 merged: Callable[[Alternative], Value], number: Callable[[Sequence[Data]], Value]) -> Value:
    """The choice that holds on all ways; `merged` makes one value of an alternative, `number` one of their numbers."""
    found, places = alternatives(heap, held)
    values = tuple(map(merged, found))
    conflict = next((v for v in values if isinstance(v, Conflict)), None)
    if conflict is not None or len(values) == 1:
        return values[0] if conflict is None else conflict
    which = number([number_of(value, place, node) for (_, value), place in zip(held, places)])
    return Choice(which, values, (*range(len(values)),)) if isinstance(which, Data) else which


def decided_again(choice: Choice, ways: Sequence[tuple[Value, Sequence[int]]]) -> Choice | None:
    """What is left of a choice where ways meet that have decided it, each for some of its numbers; None if one holds
    something else."""
    left: set[int] = set()
    for value, own in ways:
        if isinstance(value, Choice) and alike(value.number, choice.number) and alike(
                value, restricted(choice, value.numbers)):
            left |= {*value.numbers}
        elif (number := next((n for n, v in zip(choice.numbers, choice.values) if n in own and alike(v, value)), None)
              ) is not None:
            left.add(number)
        else:
            return None
    return restricted(choice, left)


def restricted(choice: Choice, numbers: Collection[int]) -> Choice:
    """A choice of which only some numbers are left."""
    held = [(n, v) for n, v in zip(choice.numbers, choice.values) if n in numbers]
    return Choice(choice.number, tuple(v for _, v in held), tuple(n for n, _ in held))
