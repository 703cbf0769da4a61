"""rotate: elements that neighbouring iterations share stay in names that move on with the loop.

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

Scalar replacement (Callahan, Carr, Kennedy, PLDI 1990): each element is loaded once and stored once, and no iteration
reads what the one before stored, so that the loop can run in vectors. Every sum is formed in the same order.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations

from s2sad.analyze.liveness import base_name
from s2sad.simplify.bounds import (
    Counted, affine, changed, counted, is_straight, never_negative, shifted_by, stores,
)
from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.tree import (
    AST, Assign, AugAssign, BoolOp, Compare, For, Gt, If, IfExp, Lt, Name, Subscript, assign, at, augment, children,
    compare, copy, dump, index, indices, name, names, rebuild, walk,
)
from s2sad.simplify.algebra import shifted, simple

CHANGES_ROUNDING = False

_WIDEST = 4


@dataclass
class Row:
    """The references to one array that differ by the shift of the counter in one axis."""
    model: Subscript
    axis: int
    shifts: set[int] = field(default_factory=set)
    sure: set[int] = field(default_factory=set)
    stored: bool = False

    def others(self) -> str:
        """The subscripts of the other axes, as a text."""
        return dump([s for k, s in enumerate(indices(self.model)) if k != self.axis])

    def place(self, at_counter: AST, shift: int) -> Subscript:
        subscripts = list(map(copy, indices(self.model)))
        subscripts[self.axis] = simple(shifted(copy(at_counter), shift), integers=True)
        return index(name(base_name(self.model)), *subscripts)


def rotated(loop: For, least: Mapping[str, int], types: Mapping[str, Type], free: Names) -> list[AST] | None:
    """The loop with such elements in names, None if it has none; `least` are bounds of the counters around it."""
    bounds = counted(loop)
    ends = bounds.ends() if bounds else None
    if bounds is None or ends is None or not is_straight(loop.body):
        return None
    inside = dict(least)
    if not ends[0].terms:
        inside[bounds.counter] = ends[0].constant
    before: list[AST] = []
    after: list[AST] = []
    body = loop.body
    for array in sorted({base_name(t) for t in stores(loop.body)}):
        for row in _rows(array, loop, bounds, inside) if array in types and types[array].is_float else []:
            first, body, last = _moved(row, body, bounds, free)
            before, after = before + first, after + last
    if body is loop.body:
        return None
    runs = compare(copy(bounds.start), Lt() if bounds.step > 0 else Gt(), copy(bounds.stop))
    made = [*before, For(loop.target, loop.iter, body, [], None), *after]
    return [at(If(runs, [at(s, loop) for s in made], []), loop)]


def _rows(array: str, loop: For, bounds: Counted, least: Mapping[str, int]) -> list[Row]:
    """The rows of an array that are worth it; none unless every reference is known not to meet another row."""
    references = [n for n in walk(loop.body) if isinstance(n, Subscript) and base_name(n) == array]
    if len(references) != sum(isinstance(n, Name) and n.id == array for n in walk(loop.body)):
        return []
    bound = changed(loop.body)
    rows: dict[str, Row] = {}
    axes: set[int] = set()
    for reference in references:
        subscripts = indices(reference)
        found = [k for k, s in enumerate(subscripts) if bounds.counter in names(s)]
        shift = shifted_by(subscripts[found[0]], bounds.counter) if len(found) == 1 else None
        if shift is None or bound & set(names(subscripts)) or any(affine(s) is None for s in subscripts):
            return []
        axes.add(found[0])
        others = [s for k, s in enumerate(subscripts) if k != found[0]]
        row = rows.setdefault(dump(others), Row(reference, found[0]))
        row.shifts.add(shift)
        row.stored = row.stored or any(reference is t for t in stores(loop.body))
        if not never_negative(affine(subscripts[found[0]]), least):
            return []
    if len(axes) != 1 or not all(_apart(a, b, least) for a, b in combinations(rows.values(), 2)):
        return []
    _note_sure(loop.body, array, bounds.counter, rows)
    return [r for r in rows.values() if r.stored and len(r.shifts) > 1 and {min(r.shifts), max(r.shifts)} <= r.sure
            and max(r.shifts) - min(r.shifts) <= _WIDEST]


def _apart(a: Row, b: Row, least: Mapping[str, int]) -> bool:
    """Whether two rows have no element in common."""
    for axis, (x, y) in enumerate(zip(indices(a.model), indices(b.model))):
        if axis == a.axis:
            continue
        left, right = affine(x), affine(y)
        if left is None or right is None:
            continue
        distance = left.plus(right, -1)
        if not distance.terms and distance.constant and never_negative(left, least) and never_negative(right, least):
            return True
    return False


def _note_sure(body: list[AST], array: str, counter: str, rows: Mapping[str, Row]) -> None:
    """Notes the shifts that every iteration refers to, whatever its tests."""
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
                shift = shifted_by(subscripts[row.axis], counter)
                if shift is not None and dump(others) == row.others():
                    row.sure.add(shift)


def _moved(row: Row, body: list[AST], bounds: Counted, free: Names) -> tuple[list[AST], list[AST], list[AST]]:
    """What stands before the loop, its body, and what stands after it."""
    array = base_name(row.model)
    low, high = min(row.shifts), max(row.shifts)
    order = list(range(low, high + 1))[::bounds.step]
    held = {shift: free.fresh(f"{array}_held") for shift in order}

    def change(node: AST) -> AST | None:
        if not isinstance(node, Subscript) or base_name(node) != array:
            return None
        subscripts = indices(node)
        shift = shifted_by(subscripts[row.axis], bounds.counter)
        if shift is None or dump([s for k, s in enumerate(subscripts) if k != row.axis]) != row.others():
            return None
        return name(held[shift])

    counter, leaving, entering = name(bounds.counter), order[0], order[-1]
    inner = [assign(held[entering], row.place(counter, entering)), *(_bound(rebuild(s, change)) for s in body),
             assign(row.place(counter, leaving), name(held[leaving])),
             *(assign(held[a], name(held[b])) for a, b in zip(order, order[1:]))]
    return ([assign(held[s], row.place(bounds.start, s)) for s in order[:-1]], inner,
            [assign(row.place(bounds.stop, s), name(held[s])) for s in order[:-1]])


def _bound(statement: AST) -> AST:
    """The statement with names that took the place of elements bound where elements were stored."""
    if isinstance(statement, If):
        return with_blocks(statement, lambda block: list(map(_bound, block)))
    if isinstance(statement, AugAssign):
        return at(augment(statement.target, statement.op, statement.value), statement)
    return at(assign(statement.targets[0], statement.value), statement) if isinstance(statement, Assign) else statement
