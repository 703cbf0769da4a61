"""The heap: what is mutable while a program is evaluated, under numbers. Persistent: a branch forks it by a copy.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from s2sad.evaluate.specialize.values import Choice, ClassValue, Data, Reference, Value, alike, parts


@dataclass(frozen=True)
class Temporary:
    """The key of a slot that no name of the user's has: what an expression or a statement needs for itself."""
    what: str
    node: int       # the id of the node that it is for

    def __str__(self) -> str:
        return self.what


@dataclass(frozen=True)
class Object:
    """A list, a dict, a set, an object of a class ("record"), a namespace of a class or a frame of a call.

    `items` go by position, key or attribute; `label` begins the names of what it holds; `site` is the node that made
    it; `path` is what a user calls it, of an argument's object; `live` is the object from outside that it is, which may
    be changed if it is reached from the object whose method is evaluated (`is_owned`). A deque holds `most` items;
    `count` says how many values a list had when it was made, those of sequences in it counted one by one.
    """
    kind: str
    items: Mapping[Hashable, Value] = field(default_factory=dict)
    made: ClassValue | None = None
    label: str = ""
    site: Any = None
    path: str = ""
    live: Any = None
    is_owned: bool = True
    most: int | None = None
    count: int = 1

    def name_of(self, key: Hashable) -> str:
        """What a residual name for the content of a slot is called."""
        if self.kind == "frame":
            return str(key).strip(".0123456789") if str(key).startswith(".") else str(key)
        return f"{self.label}_{key}" if self.label else str(key)

    @cached_property
    def occurrences(self) -> Counter[int | str]:
        """How often each object, by its number, and each residual name is held."""
        return Counter(inner for v in self.items.values() for inner in _held(v))

    @cached_property
    def has_choices(self) -> bool:
        """Whether a slot holds one of several things, or has one in what it holds."""
        return any(map(_has_choice, self.items.values()))


class Heap:
    """Objects by number; numbers are never given twice, also across forks. `mutated` are those that have held something
    else at any time, in any fork."""

    def __init__(self) -> None:
        self.objects: dict[int, Object] = {}
        self.changes = 0
        self.mutated: set[int] = set()
        self._count = 0

    def fork(self) -> dict[int, Object]:
        return dict(self.objects)

    def new(self, made: Object) -> Reference:
        self._count += 1
        self.objects[self._count] = made
        return Reference(self._count)

    def __getitem__(self, reference: Reference) -> Object:
        return self.objects[reference.number]

    def put(self, reference: Reference, key: Hashable, value: Value) -> None:
        held = self.objects[reference.number]
        self.changes += 1
        if held.kind != "frame" and not alike(held.items.get(key), value):
            self.mutated.add(reference.number)
        self.objects[reference.number] = replace(held, items={**held.items, key: value})

    def set_items(self, reference: Reference, items: Mapping[Hashable, Value]) -> None:
        self.changes += 1
        self.mutated.add(reference.number)
        self.objects[reference.number] = replace(self.objects[reference.number], items=dict(items))

    def values(self) -> Iterator[Value]:
        for held in self.objects.values():
            yield from held.items.values()

    def uses(self, name: str) -> int:
        """How many slots hold a residual name."""
        return uses(self.objects, name)

    def holders(self, reference: Reference, objects: Mapping[int, Object] | None = None) -> int:
        """How many slots hold a reference."""
        return _occurrences(self.objects if objects is None else objects, reference.number)


def uses(objects: Mapping[int, Object], name: str) -> int:
    """How many slots of a heap hold a residual name."""
    return _occurrences(objects, name)


def _occurrences(objects: Mapping[int, Object], what: int | str) -> int:
    return sum(held.occurrences.get(what, 0) for held in objects.values())


def _held(value: Value) -> Iterator[int | str]:
    if isinstance(value, Reference):
        yield value.number
    elif isinstance(value, Data):
        yield value.name
    else:
        for part in parts(value):
            yield from _held(part)


def _has_choice(value: Value) -> bool:
    return isinstance(value, Choice) or any(map(_has_choice, parts(value)))
