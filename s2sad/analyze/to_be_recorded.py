"""to_be_recorded: what the forward sweep records, what the reverse sweep computes again, and which loops it runs again.

Requires structure, activity and what each adjoint reads; establishes a `Plan`. A value that the reverse sweep reads
and that later iterations overwrite is
- computed again where its operands are intact or restored, at the top of the reverse block ("early": in the state
  that the block leaves) or of its own segment ("late": in the state in which the segment begins),
- read back from the element where it was stored ("reloaded"),
- or recorded. An element that is overwritten while something computed again still reads it is recorded and restored.
What to record is a least cut between what is lost and what is read. (To be recorded: Hascoet, Naumann, Pascual, FGCS
21, 2005; the cut: Moses et al., SC 2021.) A loop can be run forward and back per iteration: its tape is then that of
one iteration (Hascoet, Pascual, TOMS 39, 2013, II-LOOP), and snapshots of what flows from iteration to iteration.
"""
from __future__ import annotations

from s2sad.analyze.independent_iterations import carries, is_dear, rerun_arrays
from s2sad.analyze.recording_plan import RecordingPlan, PlanningInputs, Snapshot
from s2sad.analyze.recording_planner import plan_for, weight_of
from s2sad.analyze.shift import shift_of
from s2sad.tree import For

_WORTH = 3  # the forward sweep runs the loop as well if numbers or elements flow: so much less must be recorded


def to_be_recorded(question: PlanningInputs) -> RecordingPlan:
    """The plan of least weight found: loops are tried for running again, outermost first, then carried numbers for
    being read from another record."""
    plan = rerun_plan(question)
    shifts = {k: s for k, v in plan.recorded.items() if (s := shift_of(v, plan, question)) is not None}
    if shifts:
        other = plan_for(question, plan.rerun, plan.snapshots, shifts)
        plan = other if other.weight < plan.weight else plan
    return plan


def rerun_plan(question: PlanningInputs) -> RecordingPlan:
    """The plan of least weight in which loops run again."""
    plan = plan_for(question, frozenset(), ())
    for place in sorted(question.structure.places.values(), key=lambda p: p.order):
        loop = place.statement
        if isinstance(loop, For) and plan.weight and not any(id(x) in plan.rerun for x in place.loops):
            plan = _lighter(plan, loop, question)
    return plan


def _lighter(plan: RecordingPlan, loop: For, question: PlanningInputs) -> RecordingPlan:
    """The plan, or the one in which a loop runs again as well, if that is worth it."""
    arrays = rerun_arrays(loop, question)
    if arrays is None:
        return plan
    flows = bool(arrays) or carries(loop, question.structure)
    if flows and (not question.quick or is_dear(loop, question.structure)):
        return plan
    worth = _WORTH if flows else 1
    if worth * sum(weight_of(Snapshot(loop, array), question.structure) for array in arrays) >= plan.weight:
        return plan
    snapshots = (*plan.snapshots, *(Snapshot(loop, array) for array in arrays))
    other = plan_for(question, plan.rerun | {id(loop)}, snapshots)
    return other if other.weight * worth < plan.weight else plan
