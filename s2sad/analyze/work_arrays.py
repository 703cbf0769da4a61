"""work_arrays: arrays that a function, or a call of one, fills before it reads them, in the same elements each time.

What such an array holds before is not needed to run the function again: the elements that it fills are its own, and the
others stay what they are unless somebody else stores there.
"""
from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from s2sad.analyze.program_structure import ProgramStructure
from s2sad.analyze.reallocated_arrays import is_reallocated
from s2sad.liveness import base_name, read_names, targets
from s2sad.normalize.loops.hoist_allocations import is_allocation
from s2sad.tree import (
    AST, Assign, Attribute, Break, Call, Constant, Expr, For, FunctionDef, If, Name, Subscript, While, const, dump,
    index, name, names, stored_names, user_call, walk, walk_statements,
)

if TYPE_CHECKING:
    from s2sad.analyze.context import CallFacts


class Callees(Protocol):
    """What is known of calls."""

    def function_of(self, node: Call) -> FunctionDef | None: ...
    def call_writes(self, node: Call) -> list[str]: ...


def refills(function: FunctionDef, array: str, fixed: Set[str], callees: Callees, last: bool = True) -> bool:
    """Whether a function stores into the same elements of an array each time that `fixed` are the same (`p` for what a
    parameter holds, `=p` for its size), and reads none of them before it has; if it is not the `last` to store there it
    reads no others either."""
    return _Refill(function, array, fixed, callees).block(function.body, frozenset(), last)


def refilled_by_call(called: Call, array: str, known: Set[str], callees: Callees, last: bool = True) -> bool:
    """Whether a call refills an array that it is given, once, each time that the names `known` are what they are."""
    function = callees.function_of(called)
    given = [k for k, a in enumerate(called.args) if array in read_names(a)]
    if function is None or len(given) != 1 or not isinstance(called.args[given[0]], Name):
        return False
    parameters = [p.id for p in function.args.args]
    fixed = {p for p, a in zip(parameters, called.args) if isinstance(a, Constant) or is_known(a, known)}
    fixed |= {"=" + p for p, a in zip(parameters, called.args) if has_known_size(a, known)}
    return refills(function, parameters[given[0]], fixed, callees, last)


def refilled_in_loops(statement: AST, array: str, structure: ProgramStructure, calls: CallFacts) -> bool:
    """Whether a statement in loops is a call that refills an array, the same elements in each iteration."""
    loops, called = structure.place(statement).loops, getattr(statement, "value", None)
    if not loops or not isinstance(called, Call) or not user_call(called) or any(
            is_reallocated(structure, n) for n in names(called)):
        return False
    inside = [loops[0], *(p.statement for p in structure.inner[id(loops[0])])]
    changed = {base_name(t) for s in inside for t in (*targets(s), *calls.writes(s))}
    table = {*structure.typing.table}
    return calls.refills(called, array, (table - changed) | {"=" + n for n in table})


def is_known(node: AST, known: Set[str]) -> bool:
    """Whether an expression has the same values each time: of such names, and of such sizes."""
    return not any(isinstance(n, Call) and user_call(n) or isinstance(n, Subscript) and isinstance(n.value, Name)
                   for n in walk(node)) and read_names(node) <= known


def has_known_size(node: AST, known: Set[str]) -> bool:
    """Whether an array, or a part of one, has the same size each time."""
    while isinstance(node, Subscript):
        if not is_known(node.slice, known):
            return False
        node = node.value
    return isinstance(node, Name) and "=" + node.id in known


def stored_elements(function: FunctionDef, callees: Callees) -> set[str]:
    """The arrays of which a function stores elements, also by a name of a part or by a call."""
    found: set[str] = set()
    bound: list[tuple[str, set[str]]] = []
    for statement in walk_statements(function.body):
        found |= {base_name(t) for t in targets(statement) if isinstance(t, Subscript)}
        found |= {w for n in walk(statement) if isinstance(n, Call) and user_call(n) for w in callees.call_writes(n)}
        if isinstance(statement, Assign) and not is_allocation(statement):
            bound += [(t.id, read_names(statement.value)) for t in targets(statement) if isinstance(t, Name)]
    while grown := {n for name, read in bound if name in found for n in read} - found:
        found |= grown
    return found


@dataclass
class _Refill:
    """One array of a function."""
    function: FunctionDef
    array: str
    fixed: Set[str]
    callees: Callees

    def __post_init__(self) -> None:
        """`known` are the names that have the same values each time, and `=x` for those of the same size: such
        parameters, what is bound once to a known value, and the counters of loops over known ranges."""
        bound: dict[str, list[AST]] = {}
        for statement in walk_statements(self.function.body):
            for target in targets(statement):
                if isinstance(target, Name):
                    bound.setdefault(target.id, []).append(statement)
        stored = stored_elements(self.function, self.callees)
        self.known = {n for n in self.fixed if n.lstrip("=") not in bound}
        counters = {id(s) for s in _in_loops_only(self.function.body) if isinstance(s, For)}
        parameters = {p.id for p in self.function.args.args}
        waiting = {n: those for n, those in bound.items() if n not in parameters}
        while found := [n for n, those in waiting.items() if all(
                id(s) in counters and is_known(s.iter, self.known) if isinstance(s, For) else
                len(those) == 1 and isinstance(s, Assign) and is_known(s.value, self.known) for s in those)]:
            self.known |= {"=" + n for n in found} | {n for n in found if n not in stored}
            waiting = {n: those for n, those in waiting.items() if n not in found}

    def stores(self, statement: AST) -> bool:
        return any(base_name(t) == self.array for s in walk_statements(statement) for t in targets(s)) or any(
            isinstance(n, Call) and user_call(n) and self.array in self.callees.call_writes(n) for n in walk(statement))

    def reads(self, node: AST) -> bool:
        """Whether something reads elements of the array; its size is none."""
        return self.array in read_names(node)

    def block(self, block: list[AST], varying: Set[str], last: bool) -> bool:
        """Whether a block that stores into the array does so before it reads it; `varying` are the names that the loops
        around it bind: what is stored there may be one row of several. What other statements store before the next run,
        a block that is not the `last` one must not read."""
        storing = [k for k, s in enumerate(block) if self.stores(s)]
        if not storing:
            return False
        all_of_it = not any((set(names(block[k])) - set(stored_names(block[k]))) & varying for k in storing)
        filled: set[str] = set()
        for position, statement in enumerate(block):
            if position in storing:
                if not self.statement(statement, varying, last and position == storing[-1]):
                    return False
                filled |= self.places([statement]) or set()
            elif self.reads(statement) and not (last and all_of_it and position > storing[-1]) and not (
                    self.reads_only(statement, filled)):
                return False
        return True

    def places(self, block: list[AST]) -> set[str] | None:
        """The places of the array that a block without loops stores into, the same on each way through it; None if they
        are others."""
        found: set[str] = set()
        for statement in block:
            if isinstance(statement, If):
                ways = self.places(statement.body), self.places(statement.orelse)
                if ways[0] is None or ways[0] != ways[1]:
                    return None
                found |= ways[0]
            elif isinstance(statement, Assign):
                found |= {dump(t) for t in targets(statement) if base_name(t) == self.array}
            elif self.stores(statement):
                return None
        return found

    def reads_only(self, statement: AST, filled: set[str]) -> bool:
        """Whether a statement reads elements of the array that have just been stored, and no others."""
        if dump(index(name(self.array), const(...))) in filled:
            return True
        found = [n for n in walk(statement) if isinstance(n, Subscript) and base_name(n) == self.array]
        sizes = sum(isinstance(n, Attribute) and base_name(n.value) == self.array for n in walk(statement))
        count = sum(isinstance(n, Name) and n.id == self.array for n in walk(statement)) - sizes
        return len(found) == count and all(dump(n) in filled for n in found)

    def statement(self, statement: AST, varying: Set[str], last: bool) -> bool:
        """Whether a statement stores, and reads nothing of the array that it has not stored."""
        if isinstance(statement, For):
            if any(isinstance(s, Break) for s in walk_statements(statement.body)):
                return False
            inner = {*varying, statement.target.id, *stored_names(statement.body)}
            return is_known(statement.iter, self.known) and self.block(statement.body, inner, last)
        if isinstance(statement, If):
            return not self.reads(statement.test) and bool(self.places([statement])) and all(
                self.block(way, varying, False) for way in (statement.body, statement.orelse))
        if isinstance(statement, While):
            return False
        if isinstance(statement, (Assign, Expr)) and user_call(statement.value):
            last = last and not read_names(statement.value) & self.known & varying
            return refilled_by_call(statement.value, self.array, self.known, self.callees, last)
        if not isinstance(statement, Assign) or self.reads(statement.value):
            return False
        place = statement.targets[0]
        return isinstance(place, Subscript) and not self.reads(place.slice) and is_known(place.slice, self.known)


def _in_loops_only(block: list[AST]) -> Iterator[AST]:
    """The statements that no test is around."""
    for statement in block:
        yield statement
        if isinstance(statement, For):
            yield from _in_loops_only(statement.body)
