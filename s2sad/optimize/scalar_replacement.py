"""scalar_replacement: elements that the next iterations reuse live in rotating scalars.

    for j in range(1, n - 1):               a_bar_0 = a_bar[0]
        a_bar[j] = 0.0                      a_bar_1 = a_bar[1]
        a_bar[j - 1] += g                   for j in range(1, n - 1):
        a_bar[j + 1] += h                       a_bar_2 = a_bar[j + 1]
                                                a_bar_1 = 0.0
                                                a_bar_0 += g
                                                a_bar_2 += h
                                                a_bar[j - 1] = a_bar_0
                                                a_bar_0 = a_bar_1
                                                a_bar_1 = a_bar_2
                                            a_bar[n - 2] = a_bar_0
                                            a_bar[n - 1] = a_bar_1

*Requires* an innermost counted loop. *Establishes* the same sums in the same order: each element is loaded once and
stored once, and no iteration reads what the one before stored, so that the loop can vectorize. (Callahan, Carr,
Kennedy, PLDI 1990.)
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations

from s2sad.liveness import base_name
from s2sad.optimize.loop_bounds import (
    CountedLoop, affine, bound_names, counted_loop, is_loop_free, is_nonnegative, counter_offset, stored_elements,
)
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.tree import (
    AST, Assign, AugAssign, BoolOp, Compare, For, Gt, If, IfExp, Lt, Name, Subscript, assign, at, augment, children,
    compare, copy, dump, index, indices, name, names, rebuild, walk,
)
from s2sad.simplify.algebra import add_constant, simplify_index

CHANGES_ROUNDING = False

_LARGEST_DISTANCE = 4


@dataclass
class ShiftedReferences:
    """The references to one row of an array, at constant offsets from the counter in one axis; `unconditional` are the
    offsets that every iteration refers to."""
    model: Subscript
    axis: int
    shifts: set[int] = field(default_factory=set)
    unconditional: set[int] = field(default_factory=set)
    stored: bool = False

    def other_subscripts(self) -> str:
        """The subscripts of the other axes, as a text."""
        return dump([s for k, s in enumerate(indices(self.model)) if k != self.axis])

    def reference(self, at_counter: AST, shift: int) -> Subscript:
        subscripts = list(map(copy, indices(self.model)))
        subscripts[self.axis] = simplify_index(add_constant(copy(at_counter), shift), integers=True)
        return index(name(base_name(self.model)), *subscripts)


def scalar_replacement(loop: For, least: Mapping[str, int], types: Mapping[str, Type], free: Names) -> list[AST] | None:
    """The loop with such elements in names, None if it has none; `least` are bounds of the counters around it."""
    bounds = counted_loop(loop)
    ends = bounds.ends() if bounds else None
    if bounds is None or ends is None or not is_loop_free(loop.body):
        return None
    inside = dict(least)
    if not ends[0].terms:
        inside[bounds.counter] = ends[0].constant
    before: list[AST] = []
    after: list[AST] = []
    body = loop.body
    for array in sorted({base_name(t) for t in stored_elements(loop.body)}):
        for row in _replaceable_rows(array, loop, bounds, inside) if array in types and types[array].is_float else []:
            first, body, last = _replace(row, body, bounds, free)
            before, after = before + first, after + last
    if body is loop.body:
        return None
    runs = compare(copy(bounds.start), Lt() if bounds.step > 0 else Gt(), copy(bounds.stop))
    made = [*before, For(loop.target, loop.iter, body, [], None), *after]
    return [at(If(runs, [at(s, loop) for s in made], []), loop)]


def _replaceable_rows(array: str, loop: For, bounds: CountedLoop, least: Mapping[str, int]) -> list[ShiftedReferences]:
    """The rows of an array that are worth it; none unless every reference is known not to alias another row."""
    references = [n for n in walk(loop.body) if isinstance(n, Subscript) and base_name(n) == array]
    if len(references) != sum(isinstance(n, Name) and n.id == array for n in walk(loop.body)):
        return []
    bound = bound_names(loop.body)
    rows: dict[str, ShiftedReferences] = {}
    axes: set[int] = set()
    for reference in references:
        subscripts = indices(reference)
        found = [k for k, s in enumerate(subscripts) if bounds.counter in names(s)]
        shift = counter_offset(subscripts[found[0]], bounds.counter) if len(found) == 1 else None
        if shift is None or bound & set(names(subscripts)) or any(affine(s) is None for s in subscripts):
            return []
        axes.add(found[0])
        others = [s for k, s in enumerate(subscripts) if k != found[0]]
        row = rows.setdefault(dump(others), ShiftedReferences(reference, found[0]))
        row.shifts.add(shift)
        row.stored = row.stored or any(reference is t for t in stored_elements(loop.body))
        if not is_nonnegative(affine(subscripts[found[0]]), least):
            return []
    if len(axes) != 1 or not all(_are_disjoint(a, b, least) for a, b in combinations(rows.values(), 2)):
        return []
    _note_unconditional(loop.body, array, bounds.counter, rows)
    return [r for r in rows.values() if r.stored and len(r.shifts) > 1
            and {min(r.shifts), max(r.shifts)} <= r.unconditional
            and max(r.shifts) - min(r.shifts) <= _LARGEST_DISTANCE]


def _are_disjoint(a: ShiftedReferences, b: ShiftedReferences, least: Mapping[str, int]) -> bool:
    """Whether two rows have no element in common."""
    for axis, (x, y) in enumerate(zip(indices(a.model), indices(b.model))):
        if axis == a.axis:
            continue
        left, right = affine(x), affine(y)
        if left is None or right is None:
            continue
        distance = left.plus(right, -1)
        if not distance.terms and distance.constant and is_nonnegative(left, least) and is_nonnegative(right, least):
            return True
    return False


def _note_unconditional(body: list[AST], array: str, counter: str, rows: Mapping[str, ShiftedReferences]) -> None:
    """Notes the offsets that every iteration refers to, whatever its tests."""
    waiting = [s for s in body if not isinstance(s, If)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, (IfExp, BoolOp, Compare)):
            continue
        waiting += children(node)
        if isinstance(node, Subscript) and base_name(node) == array:
            for row in rows.values():
                subscripts = indices(node)
                others = [s for k, s in enumerate(subscripts) if k != row.axis]
                shift = counter_offset(subscripts[row.axis], counter)
                if shift is not None and dump(others) == row.other_subscripts():
                    row.unconditional.add(shift)


def _replace(row: ShiftedReferences, body: list[AST], bounds: CountedLoop, free: Names
             ) -> tuple[list[AST], list[AST], list[AST]]:
    """The loads before the loop, its body, and the stores behind it."""
    array = base_name(row.model)
    low, high = min(row.shifts), max(row.shifts)
    order = list(range(low, high + 1))[::bounds.step]
    held = {shift: free.fresh(f"{array}_held") for shift in order}

    def change(node: AST) -> AST | None:
        if not isinstance(node, Subscript) or base_name(node) != array:
            return None
        subscripts = indices(node)
        shift = counter_offset(subscripts[row.axis], bounds.counter)
        if shift is None or dump([s for k, s in enumerate(subscripts) if k != row.axis]) != row.other_subscripts():
            return None
        return name(held[shift])

    counter, leaving, entering = name(bounds.counter), order[0], order[-1]
    inner = [assign(held[entering], row.reference(counter, entering)),
             *(_with_scalar_target(rebuild(s, change)) for s in body),
             assign(row.reference(counter, leaving), name(held[leaving])),
             *(assign(held[a], name(held[b])) for a, b in zip(order, order[1:]))]
    return ([assign(held[s], row.reference(bounds.start, s)) for s in order[:-1]], inner,
            [assign(row.reference(bounds.stop, s), name(held[s])) for s in order[:-1]])


def _with_scalar_target(statement: AST) -> AST:
    """The statement as a binding of a scalar in place of a store of an element."""
    if isinstance(statement, If):
        return with_blocks(statement, lambda block: list(map(_with_scalar_target, block)))
    if isinstance(statement, AugAssign):
        return at(augment(statement.target, statement.op, statement.value), statement)
    return at(assign(statement.targets[0], statement.value), statement) if isinstance(statement, Assign) else statement
