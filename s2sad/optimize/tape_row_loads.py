"""tape_row_loads: a row of the tape is restored before the loop that reads it, in a loop of its own.

    for i in range(n - 1, -1, -1):                      for i in range(0, n):
        u[i] = u_stack[s, i]                                u[i] = u_stack[s, i]
        right = u[i + 1]                                for i in range(n - 1, -1, -1):
        left = u_stack[s, i - 1] if i > 0 else first        right = u[i + 1]
                                                            left = u[i - 1] if i > 0 else first

*Requires* an innermost counted loop. *Establishes* the same values: iterations read of the array only what is restored
by then. LLVM vectorizes the loop that is left: its run-time alias test needs strides that are not negative, and a tape
is read backwards.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.liveness import base_name
from s2sad.optimize.loop_bounds import (
    CountedLoop, affine, bound_names, counted_loop, is_loop_free, is_nonnegative, counter_offset, stored_elements,
)
from s2sad.tree import (
    AST, Assign, Compare, For, Gt, IfExp, Name, Subscript, at, copy, counted_for, dump, index, indices, names,
    rebuild, walk,
)

CHANGES_ROUNDING = False


def tape_row_loads(loop: For, stacks: Set[str]) -> tuple[list[AST], For]:
    """The loops that restore, and the loop that reads; `stacks` are the tape's arrays."""
    bounds = counted_loop(loop)
    ends = bounds.ends() if bounds else None
    made: list[AST] = []
    if bounds is None or ends is None or ends[0].terms or ends[0].constant < 0 or not is_loop_free(loop.body):
        return made, loop
    body, least = loop.body, {bounds.counter: ends[0].constant}
    while (first := next((s for s in body if _is_restore(s, bounds, stacks, bound_names(body))
                          and _is_movable(s, body, bounds, least)), None)) is not None:
        made.append(at(counted_for(bounds.counter, bounds.upwards(), [copy(first)]), loop))
        body = [_load_from_array(s, first, bounds) for s in body if s is not first]
    return made, at(For(loop.target, loop.iter, body, [], None), loop)


def _is_restore(statement: AST, bounds: CountedLoop, stacks: Set[str], bound: set[str]) -> bool:
    """Whether a statement is `x[..., i] = x_stack[..., i]`, with subscripts that are otherwise invariant."""
    if not isinstance(statement, Assign) or not isinstance(statement.targets[0], Subscript) or not isinstance(
            statement.value, Subscript) or base_name(statement.value) not in stacks:
        return False
    *outer, last = indices(statement.targets[0])
    *rows, column = indices(statement.value)
    return (counter_offset(last, bounds.counter) == counter_offset(column, bounds.counter) == 0
            and not (bound | {bounds.counter}) & set(names([*outer, *rows]))
            and all(affine(s) is not None for s in [*outer, *rows]))


def _is_movable(first: Assign, body: list[AST], bounds: CountedLoop, least: Mapping[str, int]) -> bool:
    """Whether the rest reads only elements of the array that are restored by then, and writes none."""
    target = first.targets[0]
    array, stack, outer = base_name(target), base_name(first.value), dump(indices(target)[:-1])
    mentions = [n for n in walk(body) if isinstance(n, Name) and n.id == array]
    references = [n for n in walk(body) if isinstance(n, Subscript) and base_name(n) == array]
    stored = [t for t in stored_elements(body) if base_name(t) in (array, stack)]
    if len(mentions) != len(references) or stored != [target] or stack in bound_names(body):
        return False
    for reference in references:
        *rows, last = indices(reference)
        shift = counter_offset(last, bounds.counter)
        if dump(rows) != outer or shift is None or shift * bounds.step > 0 or not is_nonnegative(affine(last), least):
            return False
    return array not in names(body[:body.index(first)])


def _load_from_array(statement: AST, first: Assign, bounds: CountedLoop) -> AST:
    """The statement with `x_stack[..., i - 1] if i > 0 else e` loaded from the array, which holds the row down to 0."""
    ends = bounds.ends()
    if ends is None or ends[0].terms or ends[0].constant:
        return statement
    target, row = first.targets[0], dump(indices(first.value)[:-1])

    def change(node: AST) -> AST | None:
        if not isinstance(node, IfExp) or not isinstance(node.body, Subscript) or base_name(node.body) != base_name(
                first.value) or not _is_positive_test(node.test, bounds.counter):
            return None
        *rows, last = indices(node.body)
        if dump(rows) != row or counter_offset(last, bounds.counter) != -1:
            return None
        place = index(copy(target.value), *map(copy, indices(target)[:-1]), copy(last))
        return IfExp(node.test, place, rebuild(node.orelse, change))
    return rebuild(statement, change)


def _is_positive_test(test: AST, counter: str) -> bool:
    """Whether a test is `counter > 0`."""
    if not isinstance(test, Compare) or len(test.ops) != 1 or not isinstance(test.ops[0], Gt):
        return False
    least = affine(test.comparators[0])
    return counter_offset(test.left, counter) == 0 and least is not None and not least.terms and least.constant == 0
