"""restored: a row of the tape goes back before the loop that reads it, in a loop of its own.

    for i in range(n - 1, -1, -1):                      for i in range(0, n):
        u[i] = u_stack[s, i]                                u[i] = u_stack[s, i]
        right = u[i + 1]                                for i in range(n - 1, -1, -1):
        left = u_stack[s, i - 1] if i > 0 else first        right = u[i + 1]
                                                            left = u[i - 1] if i > 0 else first

The loop left walks through arrays that stay where they are from one row of the tape to the next. Only then does LLVM
use vectors: its test that arrays do not overlap asks for strides that are not negative, and a tape is read backwards.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.analyze.liveness import base_name
from s2sad.simplify.bounds import Counted, affine, changed, counted, is_straight, never_negative, shifted_by, stores
from s2sad.tree import (
    AST, Assign, Compare, For, Gt, IfExp, Name, Subscript, at, copy, counted_for, dump, index, indices, names,
    rebuild, walk,
)

CHANGES_ROUNDING = False


def restored(loop: For, stacks: Set[str]) -> tuple[list[AST], For]:
    """The loops that restore, and the loop that reads; `stacks` are the tape's arrays."""
    bounds = counted(loop)
    ends = bounds.ends() if bounds else None
    made: list[AST] = []
    if bounds is None or ends is None or ends[0].terms or ends[0].constant < 0 or not is_straight(loop.body):
        return made, loop
    body, least = loop.body, {bounds.counter: ends[0].constant}
    while (first := next((s for s in body if _is_restore(s, bounds, stacks, changed(body))
                          and _is_only(s, body, bounds, least)), None)) is not None:
        made.append(at(counted_for(bounds.counter, bounds.upwards(), [copy(first)]), loop))
        body = [_read_in_place(s, first, bounds) for s in body if s is not first]
    return made, at(For(loop.target, loop.iter, body, [], None), loop)


def _is_restore(statement: AST, bounds: Counted, stacks: Set[str], bound: set[str]) -> bool:
    """Whether a statement is `x[..., i] = x_stack[..., i]`, with nothing else in the subscripts that the loop binds."""
    if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Subscript) or not isinstance(
            statement.value, Subscript) or base_name(statement.value) not in stacks:
        return False
    *outer, last = indices(statement.targets[0])
    *rows, column = indices(statement.value)
    return (shifted_by(last, bounds.counter) == shifted_by(column, bounds.counter) == 0
            and not (bound | {bounds.counter}) & set(names([*outer, *rows]))
            and all(affine(s) is not None for s in [*outer, *rows]))


def _is_only(first: Assign, body: list[AST], bounds: Counted, least: Mapping[str, int]) -> bool:
    """Whether the rest reads of the array only what the iterations up to its own have restored, and writes nothing."""
    target = first.targets[0]
    array, stack, outer = base_name(target), base_name(first.value), dump(indices(target)[:-1])
    mentions = [n for n in walk(body) if isinstance(n, Name) and n.id == array]
    references = [n for n in walk(body) if isinstance(n, Subscript) and base_name(n) == array]
    stored = [t for t in stores(body) if base_name(t) in (array, stack)]
    if len(mentions) != len(references) or stored != [target] or stack in changed(body):
        return False
    for reference in references:
        *rows, last = indices(reference)
        shift = shifted_by(last, bounds.counter)
        if dump(rows) != outer or shift is None or shift * bounds.step > 0 or not never_negative(affine(last), least):
            return False
    return array not in names(body[:body.index(first)])


def _read_in_place(statement: AST, first: Assign, bounds: Counted) -> AST:
    """The statement with `x_stack[..., i - 1] if i > 0 else e` read from the array, which holds the row down to 0."""
    ends = bounds.ends()
    if ends is None or ends[0].terms or ends[0].constant:
        return statement
    target, row = first.targets[0], dump(indices(first.value)[:-1])

    def change(node: AST) -> AST | None:
        if not isinstance(node, IfExp) or not isinstance(node.body, Subscript) or base_name(node.body) != base_name(
                first.value) or not _is_after_first(node.test, bounds.counter):
            return None
        *rows, last = indices(node.body)
        if dump(rows) != row or shifted_by(last, bounds.counter) != -1:
            return None
        place = index(copy(target.value), *map(copy, indices(target)[:-1]), copy(last))
        return IfExp(node.test, place, rebuild(node.orelse, change))
    return rebuild(statement, change)


def _is_after_first(test: AST, counter: str) -> bool:
    """Whether a test is `counter > 0`."""
    if not isinstance(test, Compare) or len(test.ops) != 1 or not isinstance(test.ops[0], Gt):
        return False
    least = affine(test.comparators[0])
    return shifted_by(test.left, counter) == 0 and least is not None and not least.terms and least.constant == 0
