"""statement_order: whether a nest of loops may run behind a statement that follows it, and what two loops that change
places ask of a body without loops.

    for i in range(n):              y = a.T @ v
        x[i] = v[i]                 for i in range(n):
    y = a.T @ v                         x[i] = v[i]

    for k in range(n):              for j in range(m):
        for j in range(m):              for k in range(n):
            c[j] += a[j, k]                 c[j] += a[j, k]

*Requires* that names stand for different memory. A statement is crossed if it neither writes what the nest mentions nor
reads what the nest writes, does nothing else, and all that it mentions are numbers and arrays of memory of their own.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.infer.types import Type
from s2sad.liveness import base_name, read_names, targets, touched
from s2sad.optimize.loop_bounds import CountedLoop, bound_names, stored_elements
from s2sad.optimize.loop_nests import Nest
from s2sad.tree import (
    AST, Add, Assert, Assign, Attribute, AugAssign, Call, For, If, Name, Sub, Subscript, call_name, indices, is_comment,
    names, walk, walk_statements,
)

_SHORT = 8      # iterations that are not worth a loop of their own
_PURE = ("numpy.", "math.", "builtins.")


def may_move_behind(nest: Nest, statement: AST | Nest, own: Set[str], types: Mapping[str, Type]) -> bool:
    """Whether a nest may move behind a statement, or behind another nest; `own` are the arrays that have memory of
    their own."""
    crossed = statement.with_body(statement.body) if isinstance(statement, Nest) else statement
    if is_comment(crossed):
        return True
    stored = {base_name(t) for t in stored_elements(nest.body)}
    bound = bound_names(nest.body)
    if isinstance(crossed, Assert):
        sizes = {id(n.value) for n in walk(crossed) if isinstance(n, Attribute)}
        return not {n.id for n in walk(crossed) if isinstance(n, Name) and id(n) not in sizes} & (bound | stored)
    counters = {s.target.id for s in walk_statements(crossed) if isinstance(s, For)}     # no loop leaves them behind
    written, read = touched(crossed) - counters, read_names(crossed) - counters
    mentioned = {n.lstrip("=") for n in read_names(nest.with_body(nest.body))} - {*nest.counters} | stored | bound
    return (_is_plain(crossed) and not written & mentioned and not read & (stored | bound)
            and not (written | read) & {*nest.counters} and not counters & (mentioned | bound)
            and all(_is_known(n.lstrip("="), own, types) for n in written | read))


def _is_plain(statement: AST) -> bool:
    """Whether a statement only binds and stores: what it calls has no other effects."""
    kinds = (Assign, AugAssign, For, If)
    return all(isinstance(s, kinds) or is_comment(s) for s in walk_statements(statement)) and all(
        (call_name(n) or "").startswith(_PURE) and not n.keywords for n in walk(statement) if isinstance(n, Call))


def _is_known(identifier: str, own: Set[str], types: Mapping[str, Type]) -> bool:
    """Whether a name is that of an array of its own, or of a number."""
    return identifier in own or identifier in types and types[identifier].is_number


# -- names that flow from iteration to iteration --------------------------------------------------------------------

def upward_exposed(body: list[AST]) -> set[str]:
    """The names that a body may read before it binds them."""
    found: set[str] = set()
    sure: set[str] = set()

    def visit(block: list[AST], always: bool) -> None:
        for statement in block:
            if isinstance(statement, If):
                found.update(set(names(statement.test)) - sure)
                visit(statement.body, False)
                visit(statement.orelse, False)
            elif isinstance(statement, (Assign, AugAssign)):
                read = set(names(statement.value))
                for target in targets(statement):
                    read |= set(names(target)) if isinstance(target, Subscript) else {target.id} if isinstance(
                        statement, AugAssign) else set()
                found.update(read - sure)
                if always:
                    sure.update(t.id for t in targets(statement) if isinstance(t, Name))
    visit(body, True)
    return found


def is_accumulator(identifier: str, body: list[AST]) -> bool:
    """Whether a body only increments a number."""
    increments = sum(isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub)) and isinstance(s.target, Name)
                and s.target.id == identifier for s in walk_statements(body))
    return increments == sum(isinstance(n, Name) and n.id == identifier for n in walk(body))


# -- loops that change places ---------------------------------------------------------------------------------------

def is_incremented(array: str, body: list[AST]) -> bool:
    """Whether a body does nothing with an array but increment its elements and ask for its size."""
    increments = sum(isinstance(s, AugAssign) and isinstance(s.op, (Add, Sub)) and isinstance(s.target, Subscript)
                     and base_name(s.target) == array for s in walk_statements(body))
    sizes = sum(isinstance(n, Attribute) and base_name(n.value) == array for n in walk(body))
    return increments + sizes == sum(isinstance(n, Name) and n.id == array for n in walk(body)) and not is_transposed(
        array, body)


def is_transposed(array: str, body: list[AST]) -> bool:
    """Whether a body has an array's axes in another order."""
    return any(isinstance(n, Attribute) and base_name(n.value) == array and n.attr not in ("shape", "size")
               for n in walk(body))


def strides(body: list[AST], counter: str) -> int:
    """How many references have a counter in another subscript than the last."""
    return sum(counter in names(indices(n)[:-1]) for n in walk(body) if isinstance(n, Subscript))


def stands_behind(outer: str, inner: str, body: list[AST]) -> bool:
    """Whether the counter of an outer loop stands behind that of an inner one in more references than before it, and in
    none without it."""
    behind = 0
    for node in walk(body):
        axes = indices(node) if isinstance(node, Subscript) else []
        outers, inners = ([k for k, a in enumerate(axes) if c in names(a)] for c in (outer, inner))
        if outers and not inners:
            return False
        behind += (outers[-1] > inners[-1]) - (outers[-1] < inners[-1]) if outers else 0
    return behind > 0


def is_short(loop: CountedLoop) -> bool:
    ends = loop.ends()
    return ends is not None and not (trips := ends[1].plus(ends[0], -1)).terms and trips.constant + 1 < _SHORT


def may_change_places(outer: CountedLoop, inner: CountedLoop, body: list[AST]) -> bool:
    """Whether the bounds of either loop are the same in every iteration of the other, and there where it has none."""
    bounds = [outer.start, outer.stop, inner.start, inner.stop]
    if any(isinstance(n, Subscript) and not isinstance(n.value, Attribute) for n in walk(bounds)):
        return False        # an element that need not be there
    sizes = {id(n.value) for n in walk(bounds) if isinstance(n, Attribute)}
    read = {n.id for n in walk(bounds) if isinstance(n, Name) and id(n) not in sizes}
    changed = {outer.counter, inner.counter, *bound_names(body), *(base_name(t) for t in stored_elements(body))}
    return outer.counter != inner.counter and not read & changed


def numbers_stay(body: list[AST], sums: Set[str]) -> bool:
    """Whether each number that is bound is so in every iteration before it is read, or is a sum in free order."""
    flowing = upward_exposed(body) & bound_names(body)
    always = bound_names([s for s in body if isinstance(s, (Assign, AugAssign))])
    return bound_names(body) <= always and all(n in sums and is_accumulator(n, body) for n in flowing)


__all__ = [
    "is_accumulator", "is_incremented", "is_short", "is_transposed", "may_change_places", "may_move_behind",
    "numbers_stay", "stands_behind", "strides", "upward_exposed",
]
