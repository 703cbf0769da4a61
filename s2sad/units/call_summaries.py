"""call_summaries: the stores and the edges of dependence of calls of units, and which calls are not run again."""
from __future__ import annotations

from collections.abc import Set

from s2sad.liveness import base_name, targets
from s2sad.analyze.uses import reads_own_result
from s2sad.analyze.callee_derivatives import is_kernel_call
from s2sad.analyze.work_arrays import refilled_by_call
from s2sad.tree import AST, Assign, AugAssign, Call, Expr, FunctionDef, Subscript, user_call, walk_statements
from s2sad.units.unit import Unit


class Calls:
    """Calls of units, by their titles."""
    titled: dict[str, Unit]

    def callee(self, node: Call) -> Unit | None:
        return self.titled.get(user_call(node) or "")

    def runs_once(self, node: Call) -> bool:
        """Whether a kernel's call is not run again by a reverse sweep: its derivative is the user's own, or it holds a
        loop that keeps snapshots."""
        unit = self.callee(node)
        return unit is not None and unit.runs_once

    def has_state(self, node: Call) -> bool:
        """Whether a function with a derivative of the user's own is called, by a kernel's call or further down."""
        unit = self.callee(node)
        return unit is not None and unit.has_state

    def call_writes(self, node: Call) -> list[str]:
        """The arrays that a call may store to."""
        unit = self.callee(node)
        return [] if unit is None else [base_name(node.args[p]) for p in unit.summary.written]

    def call_edges(self, node: Call) -> list[tuple[int, int | str]]:
        unit = self.callee(node)
        return [] if unit is None else list(unit.summary.edges)

    def writes(self, statement: AST) -> list[AST]:
        """The array references that a statement itself stores to."""
        found: list[AST] = [t for t in targets(statement) if isinstance(t, Subscript)]
        if is_kernel_call(statement) and (unit := self.callee(statement.value)) is not None:
            found += [statement.value.args[p] for p in unit.summary.written]
        return found

    def is_pure(self, node: Call) -> bool:
        """Whether a call stores and returns, and no more: it asserts nothing and runs no derivative of the user's."""
        unit = self.callee(node)
        return unit is not None and unit.summary.pure and not unit.runs_once

    def function_of(self, node: Call) -> FunctionDef | None:
        """The function that is called, in normal form; None if its runs may differ."""
        unit = self.callee(node)
        return None if unit is None or unit.has_state or unit.pairs else unit.function

    def refills(self, node: Call, array: str, known: Set[str]) -> bool:
        """Whether a call fills an array before it reads it, in the same elements as long as names `known` stay."""
        return refilled_by_call(node, array, known, self)

    def adjoint_after(self, statement: AST) -> bool:
        """Whether a statement's adjoint runs in the state that it leaves: it solves for what it stores, or begins its
        steps in states that it has kept."""
        unit = self.callee(statement.value) if is_kernel_call(statement) else None
        return reads_own_result(statement) if unit is None else bool(unit.kernel.residual) or unit.loop is not None


def stored_arrays(tree: FunctionDef, calls: Calls) -> set[str]:
    """The arrays that a function may store to."""
    found: set[str] = set()
    for statement in walk_statements(tree.body):
        if isinstance(statement, (Assign, AugAssign)):
            found |= {base_name(t) for t in targets(statement) if isinstance(t, Subscript)}
        if isinstance(statement, (Assign, AugAssign, Expr)) and is_kernel_call(statement):
            found |= set(calls.call_writes(statement.value))
    return found
