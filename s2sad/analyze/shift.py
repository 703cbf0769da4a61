"""shift: carried numbers that need no record of their own.

A number that a loop carries, and that is what an element held before the iteration overwrote it, is found in the
element's record, one iteration further back.

    for i in range(n):              for i in range(n - 1, -1, -1):
        here = u[i]                     left = u_stack[i - 1] if i > 0 else first
        u[i] = f(here, left)            u[i] = u_stack[i]
        left = here                     ...
"""
from __future__ import annotations

from s2sad.liveness import base_name
from s2sad.analyze.recording_plan import RecordingPlan, RecordingProblem, Shift, Store
from s2sad.analyze.trip_counts import invariant_trip_counts
from s2sad.analyze.reverse_values import ReverseValue
from s2sad.tree import AST, Assign, For, Name, Subscript, dump


def shift_of(value: ReverseValue, plan: RecordingPlan, problem: RecordingProblem) -> Shift | None:
    """How a carried number that is recorded can be read from the record of an element, if it can."""
    structure, loop = problem.structure, value.home
    if value.kind != "carried" or len(value.bindings) != 2 or not isinstance(loop, For):
        return None
    before, copied = value.bindings
    if not isinstance(before.value, Name) or not isinstance(copied.value, Name):
        return None
    load = structure.bindings.get(copied.value.id, [])
    while len(load) == 1 and isinstance(load[0], Assign) and isinstance(load[0].value, Name):
        load = structure.bindings.get(load[0].value.id, [])
    if len(load) != 1 or not isinstance(load[0], Assign) or not isinstance(load[0].value, Subscript):
        return None
    here, end = structure.place(load[0]), structure.place(copied)
    for store in plan.stores.values():
        there = structure.place(store.statement)
        same = (here.block, here.segment) == (there.block, there.segment) == (end.block, end.segment)
        plain = not here.branches and not there.branches and not end.branches or (
            here.branches == there.branches == end.branches == structure.place(loop).branches)
        last = max((k for k, x in enumerate(there.loops) if id(x) in plan.rerun), default=-1)
        home = next((x for x in there.loops if id(x) in plan.rerun), there.loops[0] if there.loops else loop)
        if (same and plain and here.loops[-1:] == (loop,) and here.order < there.order
                and dump(store.place) == dump(load[0].value) and _undisturbed(store, load[0], plan, problem)
                and invariant_trip_counts(structure, there.loops[last + 1:], home) is not None):
            return Shift(store, before.value.id, loop)
    return None


def _undisturbed(store: Store, load: AST, plan: RecordingPlan, problem: RecordingProblem) -> bool:
    """Whether nothing overwrites an element between its load and its store."""
    structure = problem.structure
    here, there = structure.place(load), structure.place(store.statement)
    between = [p.statement for p in structure.places.values() if here.order < p.order < there.order]
    return not any(base_name(t) == base_name(store.place) for s in between for t in problem.writes(s))
