"""to_be_recorded: what the forward sweep records, what the reverse sweep recomputes, and which loops it runs again.

Requires structure, activity and what can be infinite; establishes `context.plan`. A value that the reverse sweep reads
and that later iterations overwrite is
- recomputed where its operands are intact or restored, at the top of the reverse block ("early": in the state
  that the block leaves) or of its own segment ("late": in the state in which the segment begins),
- read back from the element where it was stored ("reloaded"),
- or recorded. An element that is overwritten while a recomputation still reads it is recorded and restored.
What nothing of this reads is not stored, and so overwrites nothing (`adjoint_liveness`).
What to record is a minimum cut between lost values and values that are read. (To be recorded: Hascoet, Naumann,
Pascual, FGCS 21, 2005; the cut: Moses et al., SC 2021.) A loop can be run forward and back per iteration: its tape is
then that of one iteration (Hascoet, Pascual, TOMS 39, 2013, II-LOOP), and snapshots of what flows from iteration to
iteration.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from math import inf

from s2sad.analyze.recording.adjoint_liveness import unread_stores
from s2sad.analyze.callee_derivatives import CalleeDerivative, call_adjoint, call_uses, is_kernel_call
from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.dependence import Dependence
from s2sad.analyze.independent_iterations import carries, is_expensive, iteration_state
from s2sad.analyze.kept_tapes import taped_calls, with_kept_tapes
from s2sad.analyze.reallocated_arrays import is_reallocation
from s2sad.analyze.recording_plan import RecordingPlan, RecordingProblem, Snapshot
from s2sad.analyze.recording.recording_planner import plan_for, weight_of
from s2sad.analyze.shift import shift_of
from s2sad.analyze.uses import OperandUses, uses
from s2sad.analyze.work_arrays import refilled_in_loops
from s2sad.infer.inference import Typing
from s2sad.liveness import base_name, targets
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.program import Economy
from s2sad.tree import AST, Assign, AugAssign, For, FunctionDef, Return, const, index, name

_WORTH: Mapping[Economy, float] = {"least": 5 / 4, "balanced": 2, "fastest": inf}
"""How many times less must be recorded, at the least, where the forward sweep runs the loop as well, for numbers or
elements flow."""


def to_be_recorded(function: FunctionDef, context: AnalysisContext) -> None:
    """Leaves the plan in `context.plan`, and the problem that it solves in `context.problem`."""
    context.problem = _problem(context, frozenset())
    memory = context.memory
    context.plan = recording_plan(context.problem, memory)
    calls = taped_calls(context.problem, lambda statement: _adjoint_of(statement, context, True))
    if calls:
        context.plan = with_kept_tapes(context.plan, calls, memory,
                                       lambda halves: recording_plan(_problem(context, halves), memory))
        context.problem = _problem(context, context.plan.halves)


def _adjoint_of(statement: AST, context: AnalysisContext, halves: bool) -> CalleeDerivative | None:
    """The adjoint of a call; None of any other statement, or if nothing of it is active."""
    return call_adjoint(statement, context.typing, context.activity.active, context.derive,
                        context.unbounded.adjoint_boundary, halves) if is_kernel_call(statement) else None


def _problem(context: AnalysisContext, halves: frozenset[int]) -> RecordingProblem:
    """The tables that the plan is made from, with the calls whose adjoints are in two `halves`."""
    structure, typing, active, calls = context.structure, context.typing, context.activity.active, context.calls

    def of_call(statement: AST, found: OperandUses) -> None:
        callee = _adjoint_of(statement, context, id(statement) in halves)
        if callee is not None:
            call_uses(statement, typing, callee, found)

    @cache
    def has(statement: AST) -> bool:
        return has_adjoint(statement, typing, active)

    @cache
    def read_by(statement: AST) -> OperandUses:
        return uses(statement, typing, active, of_call, context.choices)

    def reads_of(statement: AST) -> OperandUses:
        found = read_by(statement)
        return OperandUses(set(found.names), list(found.loads))     # plans add to it

    def writes(statement: AST) -> list[AST]:
        if is_reallocation(structure, statement):
            return [index(name(base_name(statement.targets[0])), const(...))]
        return calls.writes(statement)

    @cache
    def refills(statement: AST, array: str) -> bool:
        return id(statement) not in halves and refilled_in_loops(statement, array, structure, calls)

    def after(statement: AST) -> bool:
        return id(statement) in halves or calls.adjoint_after(statement)

    def runs(statement: AST) -> bool:
        called = statement.value if is_kernel_call(statement) else None
        callee = _adjoint_of(statement, context, id(statement) in halves)
        return called is not None and not calls.is_pure(called) or callee is not None and bool(
            callee.forward) or is_reallocation(structure, statement)

    problem = RecordingProblem(structure, Dependence(structure), has, reads_of, writes, after, refills)
    if context.request.split or context.request.halves:     # the forward sweep is the primal
        return problem
    return replace(problem, unread=unread_stores(problem, runs, context.request.with_primal))


def has_adjoint(statement: AST, typing: Typing, active: frozenset[str]) -> bool:
    """Whether a statement has an adjoint."""
    if isinstance(statement, Return):
        return True
    if is_kernel_call(statement):
        bound = [base_name(t) for t in targets(statement)]
        return any(b in active for b in bound) or any(
            typing.of(a).is_array and base_name(a) in active for a in statement.value.args)
    if not isinstance(statement, (Assign, AugAssign)) or is_allocation(statement):
        return False
    target = targets(statement)[0]
    return base_name(target) in active and typing.of(target).is_inexact


def recording_plan(problem: RecordingProblem, memory: Economy) -> RecordingPlan:
    """The plan of least weight found: loops are tried for running again, outermost first, then carried numbers for
    being read from another record."""
    plan = rerun_plan(problem, memory)
    shifts = {k: s for k, v in plan.recorded.items() if (s := shift_of(v, plan, problem)) is not None}
    if shifts:
        other = plan_for(problem, plan.rerun, shifts)
        plan = other if other.weight < plan.weight else plan
    return plan


def rerun_plan(problem: RecordingProblem, memory: Economy) -> RecordingPlan:
    """The plan of least weight in which loops run again."""
    plan = plan_for(problem, {})
    concerned = plan.concerned_loops(problem.structure)
    for place in sorted(problem.structure.places.values(), key=lambda p: p.order):
        loop = place.statement
        if isinstance(loop, For) and id(loop) in concerned and not any(id(x) in plan.rerun for x in place.loops):
            other = _lighter(plan, loop, problem, memory)
            if other is not plan:
                plan, concerned = other, other.concerned_loops(problem.structure)
    return plan


def _lighter(plan: RecordingPlan, loop: For, problem: RecordingProblem, memory: Economy) -> RecordingPlan:
    """The plan, or the one in which a loop runs again as well, if that is worth it."""
    state = iteration_state(loop, problem)
    if state is None:
        return plan
    flows = bool(state.flowing or state.persistent) or carries(loop, problem.structure)
    if flows and (memory == "fastest" or memory == "balanced" and is_expensive(loop, problem.structure)):
        return plan
    worth = _WORTH[memory] if flows else 1
    if worth * sum(weight_of(Snapshot(loop, array), problem.structure) for array in state.flowing) >= plan.weight:
        return plan
    other = plan_for(problem, {**plan.rerun, id(loop): state})
    return other if other.weight < plan.weight and other.weight * worth <= plan.weight else plan
