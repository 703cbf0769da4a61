"""commuting_iterations: the loops whose iterations may run in any order, so that the reverse sweep need not run them
backwards.

Requires the structure table and the plan; establishes `plan.forwards`. A loop commutes if no number and no element
flows between its iterations, except sums. What a sum overwrites may be recorded: it is restored last first, so that
such a sum counts as a store.
Forwards is the order that compilers vectorise and memory prefetches.
"""
from __future__ import annotations

from s2sad.analyze.context import AnalysisContext
from s2sad.analyze.dependence import ArrayReference
from s2sad.liveness import base_name
from s2sad.analyze.recording_plan import RecordingPlan, RecordingProblem, by_key, reads
from s2sad.analyze.program_structure import StatementPlace
from s2sad.analyze.reverse_values import ReverseValues
from s2sad.tree import AugAssign, Break, For, FunctionDef


def commuting_iterations(function: FunctionDef, context: AnalysisContext) -> None:
    """Leaves the loops in the plan."""
    assert context.plan is not None
    context.plan.forwards = commuting_loops(context.problem, context.plan)


def commuting_loops(problem: RecordingProblem, plan: RecordingPlan) -> frozenset[int]:
    """The ids of the loops whose iterations the reverse sweep may run in any order."""
    structure, values = problem.structure, problem.reverse_values
    recorded = {id(store.statement) for store in plan.stores.values()}
    found: set[int] = set()
    for place in structure.places.values():
        loop = place.statement
        if isinstance(loop, For) and not _carries(loop, values) and not _breaks(loop, problem):
            if _independent(loop, problem, recorded):
                found.add(id(loop))
    return frozenset(found)


def _carries(loop: For, values: ReverseValues) -> bool:
    return any(x is loop and not all(isinstance(b, AugAssign) for b in values.structure.bindings[n][1:])
               for n, x in values.loops.items())


def _breaks(loop: For, problem: RecordingProblem) -> bool:
    return any(isinstance(p.statement, Break) and p.loops[-1] is loop for p in problem.structure.inner[id(loop)])


def _independent(loop: For, problem: RecordingProblem, recorded: set[int]) -> bool:
    typing, dependence, inner = problem.structure.typing, problem.dependence, problem.structure.inner[id(loop)]

    def is_sum(place: StatementPlace) -> bool:
        return isinstance(place.statement, AugAssign) and id(place.statement) not in recorded

    sums = [ArrayReference.to(t, p.statement) for p in inner if is_sum(p) for t in problem.writes(p.statement)]
    stores = [ArrayReference.to(t, p.statement) for p in inner if not is_sum(p) for t in problem.writes(p.statement)]
    loads = [ArrayReference.to(x, p.statement) for p in inner for x in reads(p.statement, typing) if base_name(x)]
    stored, loaded, summed = (by_key(found, lambda r: r.array) for found in (stores, loads, sums))
    pairs = [(s, x) for s in stores for them in (stored, loaded, summed) for x in them.get(s.array, ())]
    pairs += [(s, x) for s in sums for x in loaded.get(s.array, ())]
    return not any(dependence.is_carried(a, b, loop) or dependence.is_carried(b, a, loop) for a, b in pairs)
