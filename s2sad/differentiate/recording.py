"""recording: the stack of each recorded value: of a store, a number, a snapshot, the trips of a loop.

    u[i] = ...      (u[i] is read by the reverse sweep and lost here)   ->   a stack of elements of u
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.liveness import base_name
from s2sad.analyze.recording_plan import RecordingPlan, Snapshot, Store
from s2sad.analyze.reallocated_arrays import is_reallocated
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.reverse_values import ReverseValue
from s2sad.differentiate.tape import Stack, Tape
from s2sad.infer.inference import Typing
from s2sad.infer.shapes import Shapes
from s2sad.infer.types import INT
from s2sad.tree import (
    AST, Constant, Name, Slice, Subscript, attribute, const, copy, index, indices, name, names, stored_names, tuple_of,
)


class Recording:
    """The stacks of one function, by the plan of what is recorded."""
    structure: ProgramStructure
    plan: RecordingPlan
    tape: Tape
    typing: Typing
    shapes: Shapes
    family: Mapping[str, str]

    def stores_of(self, statement: AST) -> list[Store]:
        return [s for s in self.plan.stores.values() if s.statement is statement]

    def snapshot(self, store: Store) -> AST:
        """The recorded part of a store: the place itself, or all of its array where the place's size changes."""
        place = store.place
        if not isinstance(place, Subscript) or not self.typing.of(place).is_array:
            return place
        if any(not isinstance(s, Slice) and self.typing.of(s).is_array for s in indices(place)):
            return place.value
        changing = {n for loop in self.structure.place(store.statement).loops for n in stored_names(loop)}
        self.shapes.enter(store.statement)
        fixed = self.shape_of(place)
        resized = is_reallocated(self.structure, base_name(place))
        return place.value if fixed is None or resized or changing & set(names(fixed)) else place

    def shape_of(self, place: AST) -> AST | None:
        """The shape of an array or of a part of one, as an expression."""
        if isinstance(place, Name):
            return attribute(copy(place), "shape")
        assert isinstance(place, Subscript)
        if isinstance(place.slice, Constant) and place.slice.value is Ellipsis:
            return attribute(copy(place.value), "shape")
        shape = self.shapes.of(place)
        return None if None in shape else tuple_of(*(self.shapes.extent(d) for d in shape if d is not None))

    def store_stack(self, store: Store) -> Stack:
        kept = self.snapshot(store)
        return self.tape.content_stack(store.key, kept, self.structure.place(store.statement).inside,
                                     self.shape_of(kept) if self.typing.of(kept).is_array else None)

    def restore(self, store: Store) -> list[AST]:
        """Pops the snapshot of a store."""
        return self.tape.pop(self.store_stack(store), whole_place(self.snapshot(store)))

    def content(self, store: Store) -> AST:
        kept = self.snapshot(store)
        whole = isinstance(kept, Subscript) and isinstance(kept.slice, Constant) and kept.slice.value is Ellipsis
        return copy(kept.value) if whole else copy(kept)

    def value_stack(self, key: str, value: ReverseValue) -> Stack:
        inside = self.structure.place(value.home).inside
        if value.kind == "carried":
            inside = (*inside, value.home)
        base = self.family.get(value.name, value.name)
        return self.tape.stack(key, base, self.typing.table[value.name], inside, None, value.kind == "carried")

    def snapshots_of(self, loop: AST) -> list[Snapshot]:
        return [s for s in self.plan.snapshots if s.loop is loop]

    def snapshot_stack(self, snapshot: Snapshot) -> Stack:
        inside = (*self.structure.place(snapshot.loop).inside, snapshot.loop)
        array = name(snapshot.array)
        return self.tape.stack(snapshot.key, snapshot.array, self.typing.of(array), inside, self.shape_of(array), True)

    def trip_stack(self, loop: AST) -> Stack:
        return self.tape.stack(f"trips {id(loop)}", "trips", INT, self.structure.place(loop).inside, None)


def whole_place(place: AST) -> AST:
    """The target of a restore: into the array, whose name stays bound to it."""
    return index(copy(place), const(...)) if isinstance(place, Name) else copy(place)
