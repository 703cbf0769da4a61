"""independent_iterations: the loops that can be run forward and back per iteration, so that their tape is that of
one iteration.

Requires the structure table. What flows from iteration to iteration is recorded where an iteration begins: nothing if
the iterations are independent (Hascoet, Pascual, TOMS 39, 2013: II-LOOP, here found instead of declared) or hand on
what they store in cells that nothing overwrites, as a trajectory is; else snapshots of arrays and the carried numbers
(Griewank, Walther, Evaluating Derivatives, 2008, chapter 12: each iteration starts from a checkpoint).
"""
from __future__ import annotations

from s2sad import rules
from s2sad.analyze.covered_parts import Part, cover, covered_part
from s2sad.analyze.dependence import ArrayReference
from s2sad.liveness import base_name
from s2sad.analyze.recording_plan import IterationState, RecordingProblem
from s2sad.analyze.reallocated_arrays import allocation_loops, is_carried, outlives_loop
from s2sad.analyze.program_structure import StatementPlace, ProgramStructure, heads
from s2sad.analyze.trip_counts import invariant_trip_counts
from s2sad.analyze.reverse_values import ReverseValues
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import AST, Assign, AugAssign, Call, For, While, call_name, dump, user_call, walk


def iteration_state(loop: For, problem: RecordingProblem) -> IterationState | None:
    """The arrays through which the iterations of a loop hang together; None if none can run again."""
    structure, typing = problem.structure, problem.structure.typing
    inner = structure.inner[id(loop)]
    if not any(isinstance(p.statement, (For, While)) or not structure.is_simple(p.statement) for p in inner):
        return None
    if any(type(p.statement).__name__ == "Break" and p.loops[-1] is loop for p in inner):
        return None
    if any(isinstance(n, Call) and typing.runs_once(n) for n in walk(loop.body)):
        return None
    own = {p.statement.targets[0].id for p in inner if is_allocation(p.statement)}
    if any(outlives_loop(structure, array) or is_carried(structure, array, loop) for array in own):
        return None                                     # the last array's shadow is in use before the loop is reversed
    written = {base_name(t) for p in inner for t in problem.stores(p.statement)} - own
    handed_on = [array for array in sorted(written) if not _private(array, loop, inner, problem)]
    persistent = tuple(array for array in handed_on if _persistent(array, loop, problem))
    flowing = tuple(array for array in handed_on if array not in persistent)
    around = (*structure.place(loop).loops, loop)
    if flowing and (any(allocation_loops(structure, array) for array in flowing)
                    or invariant_trip_counts(structure, around, around[0]) is None):
        return None
    return IterationState(loop, flowing, persistent, frozenset(
        id(s) for array in persistent for s in _settled(_stores(array, loop, problem), problem)))


def is_expensive(loop: For, structure: ProgramStructure) -> bool:
    """Whether a loop has products, solves and calls in it: products take longer than recording their results, and the
    adjoint of a call runs the function a second time already."""
    return any(rules.find_array(call_name(n)) is not None and not is_allocation(p.statement)
               or user_call(n) is not None and not structure.is_simple(p.statement)
               for p in structure.inner[id(loop)] for head in heads(p.statement) for n in walk(head))


def carries(loop: For, structure: ProgramStructure) -> bool:
    """Whether a number flows from iteration to iteration; a sum does not."""
    return any(x is loop and not all(isinstance(b, AugAssign) for b in structure.bindings[n][1:])
               for n, x in ReverseValues(structure).loops.items())


def _private(array: str, loop: For, inner: list[StatementPlace], problem: RecordingProblem) -> bool:
    """Whether an array that the loop writes is read in it only after the same iteration has written all of it,
    and not where the reverse sweep would find what running the loop again leaves."""
    structure = problem.structure
    start, around = structure.place(loop).order, structure.place(loop).loops
    loads, within = problem.loads.get(array, []), {p.order for p in inner}
    outside = [p for p, _ in loads if p.order not in within and (around or p.order < start)]
    if outside or any(_is_result(p.statement, array) for p in structure.places.values()
                      if p.order not in within and (around or p.order < start)):
        return False
    inside = [(p, x) for p, x in loads if p.order in within]
    if not inside:
        return True
    parts: list[Part] = []
    for place in inner:
        for target in problem.stores(place.statement):
            if base_name(target) != array or not isinstance(place.statement, Assign) or user_call(
                    place.statement.value):
                continue
            part = covered_part(target, place, loop, problem.dependence)
            if part is not None and all(p.order > place.order and _after(p, x, place, target, loop) for p, x in inside):
                parts.append(part)
    return cover(array, parts, problem.dependence)


def _persistent(array: str, loop: For, problem: RecordingProblem) -> bool:
    """Whether all that reads an array, of the primal and of adjoints, until the loop has been reversed, finds there
    what it found first, though iterations run again: no store of the loop is to a cell that was read before, and each
    gives its cell what it gave it the first time."""
    within = {p.order for p in problem.structure.inner[id(loop)]}
    stores = _stores(array, loop, problem)
    if any(not isinstance(x.statement, Assign) or user_call(x.statement.value) for x in stores):
        return False
    start, around = problem.structure.place(loop).order, problem.structure.place(loop).loops
    loads = [(p, x, True) for p, x in problem.loads.get(array, ())]
    loads += [(p, x, not problem.after(p.statement)) for p, x in problem.adjoint_loads.get(array, ())]
    before = [(ArrayReference.to(x, p.statement), same) for p, x, same in loads
              if around or p.order in within or p.order < start]
    return not any(problem.dependence.may_overwrite(x, t, same=same) for x, same in before for t in stores)


def _stores(array: str, loop: For, problem: RecordingProblem) -> list[ArrayReference]:
    """The stores of a loop to an array."""
    return [ArrayReference.to(t, p.statement) for p in problem.structure.inner[id(loop)]
            for t in problem.stores(p.statement) if base_name(t) == array]


def _settled(stores: list[ArrayReference], problem: RecordingProblem) -> list[AST]:
    """The statements whose cells no store overwrites after them."""
    return [x.statement for x in stores if not any(problem.dependence.may_overwrite(x, y) for y in stores)]


def _is_result(statement: AST, array: str) -> bool:
    """Whether an array is the result of a function of arrays, which its adjoint may read: `y[...] = solve(a, b)`."""
    return (isinstance(statement, Assign) and base_name(statement.targets[0]) == array
            and rules.find_array(call_name(statement.value)) is not None and not is_allocation(statement))


def _after(reader: StatementPlace, load: AST, place: StatementPlace, target: AST, loop: For) -> bool:
    """Whether a load comes after the whole nest that covers the array, or is to the cell just written."""
    nest = place.loops[place.loops.index(loop) + 1:]
    within = bool(nest) and any(x is nest[0] for x in reader.loops)
    return not within or dump(load) == dump(target)
