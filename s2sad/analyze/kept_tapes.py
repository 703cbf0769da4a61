"""kept_tapes: the calls whose tapes lie from the forward sweep, which runs the callee's, to the reverse sweep.

The adjoint of a call as one function runs the callee again, and its tape lies only while it does. In two halves the
callee runs once, and its tape lies beside all others. So a function's only call costs nothing, as does one that records
little beside another; where the tapes of many would add up, they run again.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf

from s2sad.analyze.callee_derivatives import CalleeDerivative, is_kernel_call
from s2sad.analyze.program_structure import StatementPlace, is_simple
from s2sad.analyze.recording_plan import RecordingPlan, RecordingProblem
from s2sad.infer.types import Type
from s2sad.program import Economy
from s2sad.tree import AST

_MORE: Mapping[Economy, float] = {"least": 1, "balanced": 5 / 4, "fastest": inf}
"""How many times the memory may be taken that all calls take as one function each."""


@dataclass(frozen=True)
class TapedCall:
    """A call with the weight of its tape."""
    statement: AST
    tape: int


def array_weight(kind: Type) -> int:
    """The weight of a value that lies on a tape."""
    return (1 if kind.dtype == "bool" else 8) * 16 ** kind.rank if kind.is_array or kind.is_number else 0


def taped_calls(problem: RecordingProblem, halves_of: Callable[[AST], CalleeDerivative | None]) -> list[TapedCall]:
    """The calls that would not run again in two halves, in the order of the text."""
    found: list[TapedCall] = []
    for place in sorted(problem.structure.places.values(), key=lambda p: p.order):
        if may_keep(place, problem):
            callee = halves_of(place.statement)
            if callee is not None and callee.tape:
                found.append(TapedCall(place.statement, callee.tape))
    return found


def may_keep(place: StatementPlace, problem: RecordingProblem) -> bool:
    """Whether a statement is a call that runs once, outside of loops and branches, with an adjoint and with arrays."""
    statement = place.statement
    return is_kernel_call(statement) and not place.inside and problem.active(statement) and not is_simple(
        statement, problem.structure.typing)


def with_kept_tapes(plan: RecordingPlan, calls: Sequence[TapedCall], memory: Economy,
                    planned: Callable[[frozenset[int]], RecordingPlan]) -> RecordingPlan:
    """The plan in which calls keep their tapes: all of them, else those that memory is there for, last ones first."""
    most = _MORE[memory] * (plan.weight + peak(calls, ()))
    chosen: frozenset[int] = frozenset()
    every = frozenset(id(c.statement) for c in calls)
    for more in (every, *(frozenset([id(c.statement)]) for c in reversed(calls) if len(calls) > 1)):
        tried = chosen | more
        if chosen == every or peak(calls, tried) > most:
            continue
        other = planned(tried)
        if other.weight + peak(calls, tried) <= most:
            plan, chosen = other, tried
            plan.halves, plan.tapes = chosen, sum(c.tape for c in calls if id(c.statement) in chosen)
    return plan


def peak(calls: Sequence[TapedCall], kept: Iterable[int]) -> int:
    """The weight of the tapes where they take most: those that are kept, until the function ends, and that of one call
    that runs again."""
    those = set(kept)
    held = sum(c.tape for c in calls if id(c.statement) in those)
    return held + max((c.tape for c in calls if id(c.statement) not in those), default=0)
