"""call_view: what a function can see when it is called, its arrays and numbers under names of its own.

    g.step(h + 1.0, 0.1)     ->      step(u, h, dt), where `self.u` is `u`; `u`, `h + 1.0`, `0.1` are given

Objects keep their numbers in the heap, so that two that are one are one in the function as well; an array that is
reached in two ways is one parameter. Two calls with the same `key` see the same but for the values of what is given.
"""
from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, is_spelled
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sparse.matrix_values import is_sparse
from s2sad.evaluate.specialize.values import (
    ClassValue, Conflict, Data, FunctionValue, Iteration, LibraryValue, MethodValue, ObjectValue, OpaqueValue,
    Reference, ScopeValue, SliceValue, SuperValue, TupleValue, Value, constant,
)
from s2sad.naming import Names, identifier
from s2sad.program import Fact

_KINDS = ("record", "list", "dict", "set", "class")
NUMBER = "a number that a call gives"


class NotSeparate(Exception):
    """A function cannot be one of its own for what it is given here, or does."""


class Changes(NotSeparate):
    """A function changes what it was given otherwise than by writing arrays."""


@dataclass(frozen=True)
class GivenLeaf:
    """An array or a number that a call gives: its name in the function, and what it is where the call is."""
    name: str
    outer: Data
    inner: Data
    is_held: bool           # by an object or a closure
    position: int           # of the parameter that it is of


class CallView:
    """What a function sees; `names` are those that it takes, `leaves` what they are given, in order; `objects` is its
    heap; `numbers` are the parameters whose numbers are known where it is called, and left open in it."""

    def __init__(self, ev: Evaluator, function: FunctionValue, given: Mapping[str, Value], baked: Collection[str]):
        self.ev, self.baked = ev, baked
        self._title = f"{id(function.captured.tree)}"
        self.names = Names()
        self.leaves: list[GivenLeaf] = []
        self.objects: dict[int, Object] = {}
        self.order: dict[int, int] = {}             # objects, as they are met
        self.numbers: dict[str, str] = {}           # by their names in the function
        self.bound: dict[str, Value] = {}
        self._by_name: dict[str, int] = {}
        self._frames: dict[int, dict[Hashable, Value]] = {}
        self._key: list[Hashable] = [bool(ev.guarded)]
        self._depth = 0
        # what is given by itself is named first
        positions = {name: k for k, name in enumerate(given)}
        for name, value in sorted(given.items(), key=lambda item: not isinstance(item[1], Data)):
            self._key.append(name)
            self._position = positions[name]
            self.bound[name] = self._parameter(name, value)
        self._position = len(given)
        self._depth = 1
        self.function = self._function(replace(function, first=(), keywords=(), defaults=()), "")
        for reference in [v for v in ev.live.values() if isinstance(v, Reference)]:
            if ev.heap[reference].is_owned:         # it may have been changed, and is reached from everywhere
                self._value(reference, ev.heap[reference].label)
        for number, items in self._frames.items():
            self.objects[number] = Object("frame", items)
        self.key = tuple(self._key)

    def demand(self, parameter: str) -> Fact:
        """What would make a parameter's number known."""
        return f"{parameter} of {self._title}", NUMBER

    def number_of(self, position: int) -> int:
        """The number of the object that was met as one of several."""
        return next(n for n, k in self.order.items() if k == position)

    # -- values ------------------------------------------------------------------------------------------------------
    def _parameter(self, name: str, value: Value) -> Value:
        known = value.known if isinstance(value, Data) and not value.name else None
        if type(known) in (int, float) and is_spelled(known) and name not in self.baked:
            own = self.names.numbered(name)
            self.numbers[own] = name
            inner = Data(tree.name(own), demands=frozenset((self.demand(name),)), shape=())
            self._key.append(("number", type(known).__name__))
            self.leaves.append(GivenLeaf(own, constant(known), inner, False, self._position))
            return inner
        return self._value(value, "" if name in ("self", "cls") else name)

    def _value(self, value: Value, wanted: str) -> Value:
        if isinstance(value, Data):
            return self._data(value, wanted)
        self._depth += 1
        try:
            return self._structure(value, wanted)
        finally:
            self._depth -= 1

    def _structure(self, value: Value, wanted: str) -> Value:
        if isinstance(value, Reference):
            return self._reference(value, wanted)
        if isinstance(value, TupleValue):
            self._key.append(("tuple", value.made, len(value.items)))
            names = self.ev.layout_of(value.made).names if value.made is not None else range(len(value.items))
            return replace(value, items=tuple(self._value(v, _path(wanted, k)) for k, v in zip(names, value.items)))
        if isinstance(value, SliceValue):
            self._key.append("slice")
            return SliceValue(tuple(self._value(v, wanted) for v in value.parts))
        if isinstance(value, Iteration) and value.kind == "range":
            self._key.append(("range", len(value.parts)))
            return replace(value, parts=tuple(self._value(v, wanted) for v in value.parts))
        if isinstance(value, FunctionValue):
            return self._function(value, wanted)
        if isinstance(value, LibraryValue):
            self._key.append(("library", value.path, len(value.first)))
            return replace(value, first=self._several(value.first, wanted), keywords=self._named(value.keywords))
        if isinstance(value, MethodValue):
            self._key.append(("method", value.name))
            return replace(value, base=self._value(value.base, wanted))
        if isinstance(value, ClassValue):
            return self._class(value)
        if isinstance(value, SuperValue):
            self._key.append("super")
            self._class(value.after)
            return replace(value, instance=self._value(value.instance, wanted))
        if isinstance(value, ScopeValue):
            self.ev.held.append(value.scope)
            self._key.append(("scope", id(getattr(value.scope, "module", value.scope))))
        elif isinstance(value, (ObjectValue, OpaqueValue, Conflict)):
            self._key.append(value)
        else:
            raise NotSeparate("something is gone through")
        return value

    def _several(self, values: tuple[Value, ...], wanted: str) -> tuple[Value, ...]:
        return tuple(self._value(v, wanted) for v in values)

    def _named(self, values: tuple[tuple[str, Value], ...]) -> tuple[tuple[str, Value], ...]:
        self._key.append(tuple(k for k, _ in values))
        return tuple((k, self._value(v, k)) for k, v in values)

    def _data(self, value: Data, wanted: str) -> Data:
        if value.is_list or value.may_be_unbound or value.name in self.ev.texts:
            raise NotSeparate("a list, a text, or what may be unbound")
        if value.is_known and not value.name and (value.is_literal or is_spelled(value.known)):
            self._key.append(("known", type(value.known).__name__, repr(value.known)))
            return value if value.is_literal else constant(value.known)
        if "." in value.name:
            self._key.append(("outside", value.name))
            return value
        if isinstance(value.node, tree.Attribute) and value.node.attr in ("shape", "dtype") or isinstance(
                value.known, tuple):
            raise NotSeparate("a shape or a dtype is given")
        place = self._by_name.get(value.name) if value.name else None
        if place is None:
            place = len(self.leaves)
            if value.name:
                self._by_name[value.name] = place
            own = self.names.numbered(identifier(wanted or value.name or "value"))
            inner = replace(value, node=tree.name(own))
            self.leaves.append(GivenLeaf(own, value, inner, self._depth > 0, self._position))
        elif self._depth > 0:
            self.leaves[place] = replace(self.leaves[place], is_held=True)
        self._key.append(("leaf", place, self.ev.paths.get(value.name), type(value.known).__name__, repr(value.known),
                          value.shape, value.demands, value.origins))
        return replace(value, node=self.leaves[place].inner.node)

    # -- the heap ----------------------------------------------------------------------------------------------------
    def _reference(self, value: Reference, wanted: str) -> Reference:
        number = value.number
        if is_sparse(value, self.ev.heap):
            raise NotSeparate("a sparse matrix is given")
        if number in self.order:
            self._key.append(("again", self.order[number]))
            return value
        held = self.ev.heap[value]
        if held.kind not in _KINDS:
            raise NotSeparate(f"an object of kind {held.kind}")
        if any(isinstance(k, (Reference, FunctionValue)) for k in held.items):
            raise NotSeparate("a key with an identity")
        self.order[number] = len(self.order)
        self._key.append((held.kind, id(held.live) if held.live is not None else None, held.is_owned, held.most,
                          held.path, tuple((type(k).__name__, k) for k in held.items)))
        if held.made is not None:
            self._class(held.made)
        self.objects[number] = held
        self.objects[number] = replace(held, label=wanted, items={
            k: self._value(v, _path(wanted, k)) for k, v in held.items.items()})
        return value

    def _class(self, value: ClassValue) -> ClassValue:
        self._key.append(("class", id(value.live)) if value.live is not None else "class")
        if value.live is None:
            self._reference(Reference(value.number), value.name)
            for base in value.bases:
                self._class(base)
        return value

    def _function(self, value: FunctionValue, wanted: str) -> FunctionValue:
        """A function, with what it finds in the frames around it."""
        self._key.append(("function", id(value.captured.tree) if value.captured else value.key, len(value.first)))
        frame = self.ev.frames.get(value.frame) if value.frame is not None else None
        if frame is not None:
            self._around(frame, mentioned(self.ev, value.captured.tree))
        if value.owner is not None:
            self._class(value.owner)
        return replace(value, first=self._several(value.first, wanted), keywords=self._named(value.keywords),
                       defaults=self._named(value.defaults))

    def _around(self, frame: Frame | None, names: frozenset[str]) -> None:
        while frame is not None:
            number = frame.reference.number
            if number not in self.ev.heap.objects:
                raise NotSeparate("a frame that has gone")
            found = self._frames.setdefault(number, {})
            self._key.append(("frame", self.order.setdefault(number, len(self.order))))
            for key, value in self.ev.heap[frame.reference].items.items():
                if key in names and key not in found:
                    found[key] = value
                    self._key.append(("slot", key))
                    self._depth += 1
                    found[key] = self._value(value, str(key))
                    self._depth -= 1
            frame = frame.outer


def _path(wanted: str, key: Any) -> str:
    return f"{wanted}_{key}" if wanted else str(key)


def mentioned(ev: Evaluator, definition: Any) -> frozenset[str]:
    """The names in a function's text that may be those of the frames around it: its own parameters hide theirs."""
    found = ev.mentioned.get(id(definition))
    if found is None:
        ev.held.append(definition)
        a = definition.args
        own = {p.id for p in (*a.posonlyargs, *a.args, *a.kwonlyargs)}
        found = ev.mentioned[id(definition)] = frozenset(n.id for n in tree.walk(definition)
                                                         if isinstance(n, tree.Name)) - own
    return found
