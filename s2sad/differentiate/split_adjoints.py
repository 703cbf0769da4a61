"""split_adjoints: calls whose adjoint is in two halves, a user's own, that of a loop which keeps snapshots, or the two
sweeps of a function. What the first saves, of any type, is on a list of the call's own, from which the second takes it;
where the call runs once it has a name.

    y = f(u, t)                     y, kept = f_forward(u, t)
                                    kept_stack.append(kept)
                                    ...
                                    kept = kept_stack.pop()
                                    f_adjoint(u, u_bar, t, y_bar, kept)
"""
from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from s2sad.liveness import targets
from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.unbounded_values import UnboundedValues
from s2sad.analyze.callee_derivatives import CalleeDerivative, Derive, call_adjoint, is_kernel_call
from s2sad.infer.types import UNKNOWN
from s2sad.naming import Names
from s2sad.tree import AST, Expr, assign, call, copy, name, tuple_of

# The list of what first halves kept, of any type: pushes and pops, as methods in the text.
EMPTY, PUSH, POP = "builtins.list", "builtins.list.append", "builtins.list.pop"


@dataclass(frozen=True)
class SavedState:
    """What a first half saves: the list that it is on ("" for none), and its name."""
    stack: str
    value: str


class SplitAdjoints:
    """The lists of one adjoint, by the calls that they belong to; those in `halves` call the sweeps of a function."""

    def __init__(self, structure: ProgramStructure, active: frozenset[str], free: Names, derive: Derive,
                 bounds: UnboundedValues, halves: Collection[int]):
        self.structure, self.typing = structure, structure.typing
        self.active, self.free, self.derive, self.bounds, self.halves = active, free, derive, bounds, halves
        self.made: dict[int, SavedState] = {}
        self.calls: dict[int, AST] = {}

    def adjoint(self, statement: AST) -> CalleeDerivative | None:
        """The adjoint of a call; None if nothing of it is active."""
        return call_adjoint(statement, self.typing, self.active, self.derive, self.bounds.adjoint_boundary,
                            id(statement) in self.halves)

    def saved_state(self, statement: AST) -> SavedState:
        """The names for what the first half of a call's adjoint saves."""
        if id(statement) not in self.made:
            repeated = bool(self.structure.place(statement).inside)
            stack = self.typing.declare(self.free.fresh("kept_stack"), UNKNOWN) if repeated else ""
            self.made[id(statement)] = SavedState(stack, self.typing.declare(self.free.fresh("kept"), UNKNOWN))
            self.calls[id(statement)] = statement
        return self.made[id(statement)]

    def forward_call(self, statement: AST) -> list[AST]:
        """The call of a first half, and the push of its state; nothing for any other statement."""
        if not is_kernel_call(statement):
            return []
        callee = self.adjoint(statement)
        if callee is None or not callee.forward:
            return []
        kept = self.saved_state(statement)
        held = [*map(copy, targets(statement)), name(kept.value)]
        if len(held) <= callee.results:                 # the call's results are not bound
            unread = [self.typing.declare(self.free.fresh("unread"), UNKNOWN) for _ in range(callee.results)]
            held = [*map(name, unread), *held]
        called = call(callee.forward, *map(copy, statement.value.args))
        push: list[AST] = [Expr(call(PUSH, name(kept.stack), name(kept.value)))] if kept.stack else []
        return [assign(held[0] if len(held) == 1 else tuple_of(*held), called), *push]

    def pop(self, statement: AST) -> list[AST]:
        """The pop of what a call's first half saved."""
        kept = self.saved_state(statement)
        return [assign(kept.value, call(POP, name(kept.stack)))] if kept.stack else []

    def stacks(self) -> list[AST]:
        """The statements that make the lists."""
        return [assign(k.stack, call(EMPTY)) for k in self.made.values() if k.stack]

    def lists(self) -> list[tuple[str, AST]]:
        """The lists of what users' functions keep, or the names of that, each with its call."""
        return [(kept.stack or kept.value, self.calls[key]) for key, kept in self.made.items()
                if (callee := self.adjoint(self.calls[key])) is not None and callee.is_own]
