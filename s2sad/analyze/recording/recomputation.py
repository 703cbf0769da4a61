"""recomputation: where in the reverse sweep a value is recomputed, and whether it can be.

Early, at the top of its block, in the state that the block leaves; late, at the top of its segment, in the state in
which the segment begins; reloaded from the element where it was stored; or lost, and so recorded.
"""
from __future__ import annotations

from s2sad.analyze.dependence import ArrayReference
from s2sad.liveness import base_name, targets
from s2sad.analyze.recording.reverse_uses import ReverseUses
from s2sad.analyze.recording_plan import Store, subscripts
from s2sad.analyze.uses import loads_of
from s2sad.analyze.reverse_values import ReverseValue
from s2sad.tree import AST, If, dump, names


class RecomputationPlaces(ReverseUses):
    """The required values, each with the place of its recomputation."""

    def place_values(self) -> None:
        for key in self.order():
            value = self.result.values[key]
            if value.kind in ("carried", "opaque"):
                self.placement[key] = "shifted" if key in self.shifts else "lost"
                continue
            own = self.segment(value.home)
            late = key not in self.first and all(
                self.location(u) == own and (not isinstance(u, str) or self.placement[u] == "late")
                for u in self.users[key])
            if value.kind == "expression" and self.is_reloaded(value):
                self.placement[key] = "early"
            elif late and self.valid(value, "late"):
                self.placement[key] = "late"
            else:
                self.placement[key] = "early" if self.valid(value, "early") else "lost"

    def order(self) -> list[str]:
        """The values, each after all values that are computed from it."""
        done: dict[str, None] = {}

        def visit(key: str) -> None:
            if key not in done and key not in waiting:
                waiting.add(key)
                for user in self.users[key]:
                    if isinstance(user, str):
                        visit(user)
                done[key] = None

        waiting: set[str] = set()
        for key in self.result.values:
            visit(key)
        return list(done)

    def segment(self, statement: AST) -> tuple[int, int]:
        place = self.structure.place(statement)
        return place.block, place.segment

    def location(self, user: AST | str) -> tuple[int, int]:
        return self.segment(self.result.values[user].home if isinstance(user, str) else user)

    def value_loads(self, value: ReverseValue) -> list[tuple[AST, AST]]:
        found = [(load, b) for b in value.bindings for load in loads_of(b.value, self.typing)]
        for _, branch in self.inputs(value):
            if isinstance(branch, If):
                found += [(load, branch) for load in loads_of(branch.test, self.typing)]
        return found

    def valid(self, value: ReverseValue, when: str) -> bool:
        """Whether every element that a value reads is intact where it is recomputed."""
        return all(not self.invalidates(store, load, statement, when)
                   for load, statement in self.value_loads(value) for store in self.stores_to.get(base_name(load), ()))

    def invalidates(self, store: Store, load: AST, statement: AST, when: str) -> bool:
        """Whether a store of an iteration overwrites an operand: before it in the segment, or after it in the block."""
        here, there = self.structure.place(statement), self.structure.place(store.statement)
        if base_name(store.place) != base_name(load) or here.block not in there.blocks or not here.loops:
            return False
        a, b = ArrayReference.to(load, statement), ArrayReference.to(store.place, store.statement)
        if when == "late":
            return (there.block, there.segment) == (here.block, here.segment) and there.order < here.order and \
                self.problem.dependence.may_overwrite(b, a, here.loops[-1])
        return there.order > here.order and self.problem.dependence.may_overwrite(a, b, here.loops[-1])

    def is_reloaded(self, value: ReverseValue) -> bool:
        """Whether a value is reloaded from the element where it was stored, in place of an operand of its own."""
        stored = self.stored_at(value)
        if stored is None or self._segment_branches(stored) != len(self.structure.place(stored).branches):
            return False
        indices = [self.all_values.at(n, stored) for n in names(subscripts(stored))]
        if any(v is not None and self.all_values.transient(v, self.rerun) for v in indices):
            return False
        place = targets(stored)[0]
        chain = self.chain(value, set())
        made_from = any(base_name(load) == base_name(place) and dump(load) == dump(place) for load, _ in chain)
        later = any(self.invalidates(other, place, stored, "early") for other in self.stores_to[base_name(place)])
        if made_from and not later:
            self.result.reloaded[value.key] = stored
        return made_from and not later

    def stored_at(self, value: ReverseValue) -> AST | None:
        home = self.structure.place(value.home)
        for store in self.stored.get(value.name, ()):
            statement, place = store.statement, self.structure.place(store.statement)
            if not store.whole and place.block == home.block and place.branches == home.branches:
                typing = self.structure.typing      # an array of another dtype holds another number
                return statement if typing.of(statement.targets[0]).dtype == typing.of(statement.value).dtype else None
        return None

    def chain(self, value: ReverseValue, seen: set[str]) -> list[tuple[AST, AST]]:
        """The loads behind a value, through the values of its own block."""
        seen.add(value.key)
        found = self.value_loads(value)
        for name, statement in self.inputs(value):
            inner = self.all_values.at(name, statement)
            if inner is not None and inner.key not in seen and inner.kind == "expression":
                found += self.chain(inner, seen)
        return found
