"""Joins: where several ways meet, and what a loop changes.

    if c: s = a            if c: s = a              where slots hold different names, both ways bind one
    else: t.u = b          else: t_u = b

Unshared structures of one shape are joined leaf by leaf; whatever else differs is a `Conflict`, refused where it is
read.
"""
from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.heap import Object, Temporary, uses
from s2sad.evaluate.specialize.signals import Unevaluated
from s2sad.evaluate.specialize.values import (
    UNKNOWN, Choice, Conflict, Data, Reference, ResidualObject, SliceValue, TupleValue, Value, alike, parts, renamed,
    with_parts,
)
from s2sad.evaluate.specialize.control.choice_joins import (
    Alternative, alternatives, are_functions, chosen_value, decided_again, is_chosen, maybe_unbound,
)
from s2sad.evaluate.specialize.sequences.known_shapes import shape
from s2sad.evaluate.specialize.sequences.listed_records import same_rows
from s2sad.evaluate.specialize.control.joined_names import Merged, Objects, Way, same_things, settled_names
from s2sad.evaluate.specialize.sparse.matrix_values import KINDS
from s2sad.program import Fact
from s2sad.tree import AST

MOST_OBJECTS = 4        # of which a slot holds one, before they are rows of a table


class Join:
    """Several ways become one; `block` of each gets the moves to common names."""

    def __init__(self, ev: Evaluator, ways: Sequence[Way], origin: AST, demands: frozenset[Fact] = frozenset(),
                 since: int = 0, decided: Choice | None = None, begun: int = -1):
        self.since = since              # when the ways parted
        self.begun = begun              # names as old as this are bound on all ways
        self.ev, self.ways, self.origin = ev, ways, origin
        self.decided = decided          # a choice of which each way has some alternatives
        self.merged: list[Merged] | None = None     # while names are not settled
        self.demands = demands          # what would tell the way
        self.made: dict[tuple[Reference, ...], Reference] = {}
        self.found: Objects = {}
        self.parted: dict[int, Unevaluated] = {}    # queues of another length on each way

    def objects(self) -> Objects:
        """The common heap; names that differ are bound on all ways."""
        self.merged = []
        for way in self.ways:
            self.ev.fill(way.objects)
        numbers = dict.fromkeys(n for w in self.ways for n in w.objects)
        for n in numbers:
            held = [w.objects[n] for w in self.ways if n in w.objects]
            if len(held) < len(self.ways) or all(h is held[0] for h in held[1:]):
                self.found[n] = held[0]
                if self.ev.choices and len(held) < len(self.ways):
                    self.found[n] = replace(held[0], items={
                        k: self._on_some(v) for k, v in held[0].items.items()})
                continue
            if _is_parted(held):
                self.parted[n] = self._of_lengths(held[0])
                continue
            self.found[n] = self._object(held)
        self._refuse_parted()
        names = settled_names(self.ev, self.ways, self.merged, self.since, self.origin)
        self.merged = None
        for n, held in self.found.items():
            if not names.keys().isdisjoint(held.occurrences):
                self.found[n] = replace(held, items={k: renamed(v, names) for k, v in held.items.items()})
        return self.found

    def _object(self, held: Sequence[Object]) -> Object:
        one = held[0]
        if one.kind in ("list", "set") and any(len(h.items) != len(one.items) for h in held):
            raise self._of_lengths(one)
        keys = dict.fromkeys(k for h in held for k in h.items)
        return replace(one, items={k: self.told(self._slot(one, k, [h.items.get(k) for h in held])) for k in keys})

    def _of_lengths(self, held: Object) -> Unevaluated:
        return self.ev.unknown(self.origin, f"'{held.label or 'a list'}' has another length on each way",
                               help="append to it on both, or on none", site=held.site)

    def _refuse_parted(self) -> None:
        """A queue of another length on each way is not to be asked for, where only names and objects of the kernel's
        own hold it."""
        for n, held in list(self.found.items()) if self.parted else ():
            if self.parted.keys().isdisjoint(held.occurrences):
                continue
            items = dict(held.items)
            for key in (k for k, v in held.items.items() if self._holds_parted(v)):
                if held.path or held.live is not None or isinstance(key, Temporary) or str(key).startswith("."):
                    raise next(iter(self.parted.values()))
                items[key] = self._in_parts(held.name_of(key))
            self.found[n] = replace(held, items=items)

    def _in_parts(self, wanted: str) -> Conflict:
        return Conflict(f"'{wanted}' has another length on each way", help="append to it on both, or on none")

    def _holds_parted(self, value: Value) -> bool:
        return isinstance(value, Reference) and value.number in self.parted or any(
            map(self._holds_parted, parts(value)))

    def _on_some(self, value: Value) -> Value:
        """A value that some ways do not have; names that were bound before are there on all."""
        return maybe_unbound(value, lambda name: self.ev.born.get(name, 0) > self.since)

    def told(self, value: Value) -> Value:
        """A value, which facts may settle."""
        return replace(value, demands=value.demands | self.demands) if isinstance(value, Conflict) else value

    def _slot(self, held: Object, key: Hashable, values: list[Value | None]) -> Value:
        wanted = held.name_of(key)
        there = [v for v in values if v is not None]
        if len(there) < len(values):
            if isinstance(key, Temporary) or str(key).startswith("."):     # what is not done on the other way
                return Conflict("something is gone through on one way only")
            if held.kind in ("dict", "record"):
                return Conflict(f"'{wanted}' is set on one way only")
            return self._bound_on_some(values, wanted)
        return self.meet(there, wanted)

    def _bound_on_some(self, values: list[Value | None], wanted: str) -> Value:
        """A name that is bound on some ways only: variables of its own, bound there."""
        return self.bound_on([(w, v) for w, v in zip(self.ways, values) if v is not None], wanted)

    def bound_on(self, there: Sequence[tuple[Way, Value]], wanted: str, tests: Sequence[AST | None] = ()) -> Value:
        """The value for those of some ways, which the others do not have; `tests` say where a way has it."""
        one = there[0][1]
        named = isinstance(one, Data) and not one.is_list      # a name of its own says where it is bound
        if self.begun >= 0 and not named and all(alike(one, v) and self._is_on_all(v) for _, v in there):
            return one
        inner = [_inner(w.objects, v) for w, v in there]
        if inner[0] is not None and all(i is not None and i[0] == inner[0][0] for i in inner):
            items = {k: self.bound_on([(w, i[1][k]) for (w, _), i in zip(there, inner) if i], f"{wanted}_{k}", tests)
                     for k in inner[0][1]}
            if isinstance(one, (TupleValue, ResidualObject)):
                return with_parts(one, [*items.values()])
            assert isinstance(one, Reference)
            listed = [sites for _, v in there if (sites := self.ev.listed_sites(v)) is not None]
            if listed or all(self.ev.heap.holders(v, w.objects) == 1 for w, v in there if isinstance(v, Reference)):
                made = self.ev.heap.new(replace(there[0][0].objects[one.number], items=items, label=wanted))
                self.found[made.number] = self.ev.heap.objects.pop(made.number)
                self.ev.in_lists |= {made.number: set().union(*listed)} if listed else {}
                return made
        data = [(w, v) for w, v in there if isinstance(v, Data)]
        if len(data) < len(there) or any(v.is_known and not isinstance(v.known, (int, float)) for _, v in data):
            several = any(not alike(one, v) for _, v in there[1:])
            if several and wanted in self.ev.choices and self._are_there(v for _, v in there) and len(
                    alternatives(self.ev.heap, [(w.objects, v) for w, v in there])[0]) > 1:
                return self._choice(there, wanted)
            return Conflict(f"'{wanted}' is bound on one way only", choice=wanted if several else "",
                            help="bind it before the branch or the loop, too")
        name = data[0][1].name
        if name and all(v.name == name and uses(w.objects, name) == 1 for w, v in data):
            return replace(data[0][1], known=UNKNOWN, may_be_unbound=True)
        found = self._one_name(data, wanted, tests)
        return replace(found, may_be_unbound=True) if isinstance(found, Data) else found

    def _are_there(self, values: Iterable[Value]) -> bool:
        """Whether structures may be alternatives: behind a loop, those that were there before it."""
        return self.begun < 0 or all(self._is_on_all(v) for v in values if isinstance(v, Reference))

    def _is_on_all(self, value: Value) -> bool:
        """Whether a value was there before the ways parted."""
        if isinstance(value, Data):
            return not value.may_be_unbound and bool(value.name) and self.ev.born.get(value.name, 0) <= self.begun
        if isinstance(value, Reference):
            return all(value.number in w.objects and same_things(
                self.ways[0].objects, value, w.objects, value) for w in self.ways)
        return isinstance(value, (TupleValue, ResidualObject)) and all(map(self._is_on_all, parts(value)))

    def _one_name(self, data: Sequence[tuple[Way, Data]], wanted: str, tests: Sequence[AST | None] = ()
                  ) -> Data | Conflict:
        """A name that all these ways bind; one that may be unbound on some is bound on the others, or where a test says
        that it is bound."""
        partly = {v.name for _, v in data if v.may_be_unbound}
        new = next(iter(partly), "")
        if partly and (len(partly) > 1 or not new or any(
                uses(w.objects, new) != (v.name == new) for w, v in data) or new in self.ev.leaves):
            if not all(test or not v.may_be_unbound for (_, v), test in zip_longest(data, tests)):
                return Conflict(f"'{wanted}' is bound on some ways only")
            new = self.ev.fresh(wanted)
        if not new and self.merged is not None:
            self.merged.append(Merged(f"?{len(self.merged)}", wanted, data))
            return Data(tree.at(tree.name(self.merged[-1].name), self.origin), is_list=any(v.is_list for _, v in data),
                        rows=same_rows(v for _, v in data))
        new = new or self.ev.fresh(wanted)
        for (way, v), test in zip_longest(data, tests):
            if v.name != new:
                move = tree.at(tree.assign(new, tree.copy(v.node)), self.origin)
                way.block.append(tree.at(tree.If(tree.copy(test), [move], []), self.origin) if (
                    test and v.may_be_unbound) else move)
        return Data(tree.at(tree.name(new), self.origin), may_be_unbound=bool(partly),
                    is_list=any(v.is_list for _, v in data), rows=same_rows(v for _, v in data))

    def meet(self, values: Sequence[Value], wanted: str) -> Value:
        """One value for those of all ways."""
        one = values[0]
        if self.parted and any(map(self._holds_parted, values)):
            return self._in_parts(wanted)
        if any(isinstance(v, Reference) and v.number not in w.objects for w, v in zip(self.ways, values)):
            return Conflict(f"'{wanted}' is made on one way only")
        if all(alike(one, v) for v in values[1:]):
            return next((v for v in values if isinstance(v, Data) and v.may_be_unbound), one)
        again = None if self.decided is None else decided_again(self.decided, [
            (v, w.alternatives) for v, w in zip(values, self.ways)])
        if again is not None:
            return again
        if are_functions(values) or any(isinstance(v, Choice) for v in values):
            return self._choice([*zip(self.ways, values)], wanted)
        found = self._same_kind(values, wanted)
        if not isinstance(found, Conflict) or any(
                isinstance(v, Reference) and w.objects[v.number].kind in KINDS for w, v in zip(self.ways, values)):
            return found
        return self._choice([*zip(self.ways, values)], wanted) if wanted in self.ev.choices else replace(
            found, choice=wanted)

    def _same_kind(self, values: Sequence[Value], wanted: str) -> Value:
        if all(isinstance(v, Data) for v in values):
            return self._data(values, wanted)  # pyright: ignore[reportArgumentType]
        if all(isinstance(v, TupleValue) for v in values):
            tuples: Any = values
            if len({(len(t.items), t.made) for t in tuples}) == 1:
                return replace(tuples[0], items=tuple(
                    self.meet([t.items[k] for t in tuples], f"{wanted}_{k}") for k in range(len(tuples[0].items))))
        if isinstance(values[0], ResidualObject) and all(
                isinstance(v, ResidualObject) and v.table is values[0].table for v in values):
            numbers = [v.number for v in values if isinstance(v, ResidualObject)]
            return with_parts(values[0], [self.meet(numbers, wanted)])
        if all(isinstance(v, SliceValue) for v in values):
            slices: Any = values
            return SliceValue(tuple(self.meet([s.parts[k] for s in slices], wanted) for k in range(3)))
        if all(isinstance(v, Reference) for v in values):
            return self._reference(values, wanted)  # pyright: ignore[reportArgumentType]
        return Conflict(f"'{wanted}' is one thing on one way and another on another")

    def _choice(self, there: Sequence[tuple[Way, Value]], wanted: str) -> Value:
        """One of the values of some ways, with a number that tells which."""
        self._ask_for_rows(there, wanted)

        def merged(one: Alternative) -> Value:
            first = one.held[0][2]
            if all(alike(first, v) for _, _, v in one.held):
                return first if len(one.held) == len(self.ways) else self._on_some(first)
            return self.bound_on([(there[w][0], v) for w, _, v in one.held], wanted, [
                is_chosen(there[w][1], j, self.origin) for (w, _, _), j in zip(one.held, one.numbers)])

        def number(numbers: Sequence[Data]) -> Value:
            if len(numbers) == len(self.ways):
                return self.meet(numbers, f"{wanted}_which")
            return self.bound_on([(w, n) for (w, _), n in zip(there, numbers)], f"{wanted}_which")
        return chosen_value(self.ev.heap, [(w.objects, v) for w, v in there], self.origin, merged, number)

    def _ask_for_rows(self, there: Sequence[tuple[Way, Value]], wanted: str) -> None:
        """Asks for the objects of a class as rows of a table, where there are many."""
        several = {one.number: w.objects.get(one.number) for w, v in there for one in (
            v.values if isinstance(v, Choice) else (v,)) if isinstance(one, Reference)}
        if len(several) > MOST_OBJECTS and not self.ev.prefers_choices:
            made = {None if held is None or held.kind != "record" else held.site for held in several.values()}
            if None not in made:
                raise self.ev.rows_wanted(made, self.ev.refusal(
                    self.origin, f"'{wanted}' is one of many objects", help="keep them in arrays"))

    def _data(self, values: Sequence[Data], wanted: str) -> Value:
        if any(v.is_known and (v.known is None or isinstance(v.known, str)) and v.is_literal for v in values):
            return Conflict(f"'{wanted}' is {_said(values)} on different ways, which must be known before the run")
        demands = frozenset().union(*(v.demands for v in values))
        shapes = {*map(shape, values)}
        kept = shapes.pop() if len(shapes) == 1 else None
        origins = frozenset().union(*(v.origins for v in values))
        maybe = any(v.may_be_unbound for v in values)
        if len({v.name for v in values}) == 1 and values[0].name:
            return Data(values[0].node, demands=demands, shape=kept, origins=origins, may_be_unbound=maybe,
                        is_list=any(v.is_list for v in values), rows=same_rows(values))
        found = self._one_name(list(zip(self.ways, values)), wanted)
        return replace(found, demands=demands, shape=kept, origins=origins) if isinstance(found, Data) else found

    def _reference(self, values: Sequence[Reference], wanted: str) -> Value:
        key = tuple(values)
        if key in self.made:
            return self.made[key]
        held = [w.objects.get(v.number) for w, v in zip(self.ways, values)]
        objects = [h for h in held if h is not None]
        listed = [sites for v in values if (sites := self.ev.listed_sites(v)) is not None]
        alone = len(listed) == len(values) or all(      # nothing changes what is listed: a copy is as good
            self.ev.heap.holders(v, w.objects) <= 1 for w, v in zip(self.ways, values))     # none of a result's
        one = objects[0]
        alike_made = len(objects) == len(values) and all(
            (h.kind, h.made, tuple(h.items)) == (one.kind, one.made, tuple(one.items)) for h in objects)
        if not alone or not alike_made or one.kind in ("frame", "class") or any(h.path or h.live for h in objects):
            return Conflict(f"'{wanted}' is one structure on one way and another on another")
        if one.kind in KINDS and not all(alike(one.items["shape"], h.items["shape"]) for h in objects):
            return Conflict(f"'{wanted}' is a sparse matrix of one shape on one way and of another on another")
        made = self.made[key] = self.ev.heap.new(replace(one, items={}, label=wanted))
        self.ev.in_lists |= {made.number: set().union(*listed)} if listed else {}
        del self.ev.heap.objects[made.number]
        items = {k: self.meet([h.items[k] for h in objects], f"{wanted}_{k}") for k in one.items}
        self.found[made.number] = replace(one, items=items, label=wanted)
        return made


def _is_parted(held: Sequence[Object]) -> bool:
    """Whether a queue of the kernel's own, which is no list of the residual program, has another length on each way."""
    one = held[0]
    return one.kind == "list" and one.site is None and not one.path and one.live is None and any(
        len(h.items) != len(one.items) for h in held)


def _inner(objects: Objects, value: Value) -> tuple[Any, dict[Any, Value]] | None:
    """The make and the items of a structure that nothing else is likely to hold."""
    if isinstance(value, ResidualObject):
        return value.table, {0: value.number}
    if isinstance(value, TupleValue):
        return (("tuple", value.made, len(value.items)), dict(enumerate(value.items)))
    held = objects.get(value.number) if isinstance(value, Reference) else None
    if held is None or held.kind in ("frame", "class") or held.path or held.live is not None:
        return None
    return ((held.kind, held.made, tuple(held.items)), dict(held.items))


def _said(values: Sequence[Data]) -> str:
    return " and ".join(dict.fromkeys(repr(v.known) if v.is_known else "a number or an array" for v in values))
