"""reverse_values: the numbers of a function as the reverse sweep sees them.

Requires the structure table. A value is a number's name, or, for a number that a loop carries, what it holds where an
iteration begins (`name@in`). Its home is the block that binds it.
"""
from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.reallocated_arrays import reads_carried
from s2sad.tree import AST, Assign, If, names


@dataclass(frozen=True)
class ReverseValue:
    """`kind`: "expression" (recomputed from its operands), "merge" (recomputed by its branches),
    "carried" (held where an iteration begins) or "opaque" (what a loop or a call leaves)."""
    key: str
    name: str
    kind: str
    bindings: tuple[AST, ...]
    home: AST

    def reads(self) -> list[tuple[str, AST]]:
        """The names, each with the statement that reads it, that a recomputation of the value reads."""
        return [(n, b) for b in self.bindings for n in names(b.value)]


class ReverseValues:
    """The values of one function, by name and place of use."""

    def __init__(self, structure: ProgramStructure):
        self.structure = structure
        self.loops: dict[str, AST] = {}
        self._again: dict[AST, bool] = {}       # whether a statement's value can be computed again
        for name, bound in structure.bindings.items():
            if name not in structure.loop_of and len(bound) > 1:
                loop = self._loop(bound)
                if loop is not None:
                    self.loops[name] = loop

    def _loop(self, bound: list[AST]) -> AST | None:
        """The loop that carries a number: around its later bindings, not around the first."""
        outer = self.structure.place(bound[0]).loops
        for binding in bound[1:]:
            inner = self.structure.place(binding).loops
            if len(inner) > len(outer):
                return inner[len(outer)]
        return None

    def at(self, name: str, user: AST) -> ReverseValue | None:
        """The value of a name that a statement reads; None for counters, parameters and arrays."""
        bound = self.structure.bindings.get(name)
        if not bound or name in self.structure.loop_of or self.structure.typing.table[name].is_array:
            return None
        loop = self.loops.get(name)
        if loop is not None:
            if any(loop is s for s in self.structure.place(user).inside):
                return ReverseValue(f"{name}@in", name, "carried", tuple(bound), loop)
            return ReverseValue(name, name, "opaque", tuple(bound), loop)
        if len(bound) > 1:
            merge = self._merge(bound)
            simple = self.structure.is_simple(merge)
            return ReverseValue(name, name, "merge" if simple else "opaque", tuple(bound), merge)
        statement = bound[0]
        if statement not in self._again:
            self._again[statement] = isinstance(statement, Assign) and self.structure.is_simple(
                statement) and not reads_carried(self.structure, statement)
        return ReverseValue(name, name, "expression" if self._again[statement] else "opaque", (statement,), statement)

    def _merge(self, bound: list[AST]) -> AST:
        """The innermost branch statement around all bindings."""
        chains = [[s for s in self.structure.place(b).inside] for b in bound]
        common = [s for s in chains[0] if all(any(s is t for t in c) for c in chains[1:])]
        return next(s for s in reversed(common) if isinstance(s, If))

    def transient(self, value: ReverseValue, rerun: Collection[int]) -> bool:
        """Whether later iterations overwrite a value before the reverse sweep reads it."""
        if value.kind == "carried":
            return True
        loops = self.structure.place(value.home).loops
        return bool(loops) and id(loops[-1]) not in rerun

