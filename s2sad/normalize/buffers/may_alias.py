"""may_alias: which buffers may, in NumPy, be the same array as another one, and the stores that make them differ.

Used by `loop_carried`, which fills a buffer where NumPy binds a name. A copy is as good as the array itself as long as
neither is stored into while the other one may be read (`UpcomingUses`). Arrays of parameters may always be read: the
caller has them.
"""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from s2sad.diagnostics import Report
from s2sad.tree import (
    AST, AugAssign, Break, Continue, For, FunctionDef, If, Name, While, names, stored_names,
)


@dataclass
class _Loop:
    """A loop that is being read: its buffers, the arrays from before it, the names that it binds, and the moves at
    the end of an iteration."""
    buffers: frozenset[str]
    known: frozenset[str]
    bound: frozenset[str]
    moves: list[tuple[str, str]] = field(default_factory=list)


class Aliases:
    """Pairs of arrays that NumPy may hold in one, moves from buffer to buffer, and all stores."""

    def __init__(self, visible: Iterable[str]):
        self.visible = frozenset(visible)
        self._pairs: set[tuple[str, str]] = set()
        self._flows: set[tuple[str, str]] = set()
        self._stores: list[tuple[str, AST, frozenset[str]]] = []
        self._loops: list[_Loop] = []

    def note_copy(self, base: str, buffer: str, lasts: bool) -> None:
        """A buffer is made from an array; both may be one if that `lasts`, and the buffer may be what the array was."""
        if base != buffer:
            self._flows.add((base, buffer))
            self._pairs |= {(base, buffer), (buffer, base)} if lasts else set()

    def is_shared(self, buffer: str) -> bool:
        """Whether a buffer may, so far, be the same array as another one."""
        return any(a == buffer for a, _ in self._pairs)

    def begin_loop(self, buffers: Iterable[str], known: Iterable[str], bound: Iterable[str]) -> None:
        self._loops.append(_Loop(frozenset(buffers), frozenset(known), frozenset(bound)))

    def is_loop_invariant(self, identifier: str, is_array: bool) -> bool:
        """Whether an array, or a number, is from before the loop."""
        loop = self._loops[-1]
        return identifier in loop.known | loop.buffers if is_array else identifier not in loop.bound

    def may_be_stored_again(self, base: str, older: Iterable[str]) -> bool:
        """Whether an array from before a branch may be stored into again after it, under its own name: not one that
        every iteration of the loop here allocates."""
        loop = self._loops[-1] if self._loops else None
        return base in older and (loop is None or base in loop.known | loop.buffers)

    def end_loop(self) -> None:
        self._loops.pop()

    def note_fill(self, buffer: str, base: str) -> None:
        """At the end of an iteration the buffer is filled from an array."""
        self._loops[-1].moves.append((buffer, base))

    def end_iteration(self) -> None:
        """The iteration ends: buffers that take one array share it, what is older than the loop stays what it is."""
        loop = self._loops[-1]
        for place, (buffer, base) in enumerate(loop.moves):
            self.note_copy(base, buffer, base in loop.known - loop.buffers)
            for other, same in loop.moves[:place]:
                if same == base:
                    self.note_copy(other, buffer, True)
        loop.moves = []

    def note_binding(self, one: dict[str, str]) -> None:
        """Arrays go under other names."""
        if one:
            self._pairs = {(one.get(a, a), one.get(b, b)) for a, b in self._pairs}
            self._flows = {(one.get(a, a), one.get(b, b)) for a, b in self._flows}
            self._stores = [(one.get(a, a), s, frozenset(one.get(n, n) for n in near)) for a, s, near in self._stores]

    def note_store(self, base: str, statement: AST, near: Iterable[str]) -> None:
        """A statement writes an array; the arrays that are used later."""
        self._stores.append((base, statement, frozenset(near)))

    def check(self, report: Report) -> bool:
        """Refuses the stores after which a buffer would differ from NumPy's array; whether there are any."""
        pairs, found = self._closed(), False
        for base, statement, near in self._stores:
            if any(a == base and (b in self.visible or b in near) for a, b in pairs):
                found = True
                report.error("S201", "an array is written that another name may stand for here, as it did before a "
                             "loop or branch bound it anew", statement,
                             help="bind the name to a copy before the loop or branch: u = u.copy(); "
                             "where names swap in a branch, swap what their arrays hold")
        return found

    def _closed(self) -> set[tuple[str, str]]:
        """The pairs, also of the buffers that arrays move to."""
        pairs = {(a, b) for a, b in self._pairs if a != b}
        while True:
            grown = {pair for a, b in pairs for start, end in self._flows if start == a and end != b
                     for pair in ((end, b), (b, end))} - pairs
            if not grown:
                return pairs
            pairs |= grown


class UpcomingUses:
    """The names used after a statement before they are bound anew, `after[id(statement)]`, and from where the body of a
    loop begins, `head[id(loop)]`."""

    def __init__(self, function: FunctionDef):
        self.after: dict[int, set[str]] = {}
        self.head: dict[int, set[str]] = {}
        self._again: list[set[str]] = []        # what is used behind a `continue` of each loop around
        self._block(function.body, set(), set())

    def _block(self, block: list[AST], live: set[str], at_break: set[str]) -> set[str]:
        for statement in reversed(block):
            self.after[id(statement)] = set(live)
            live = self._statement(statement, live, at_break)
        return live

    def _statement(self, statement: AST, live: set[str], at_break: set[str]) -> set[str]:
        if isinstance(statement, Break):
            return set(at_break)
        if isinstance(statement, Continue) and self._again:
            return set(self._again[-1])
        if isinstance(statement, If):
            arms = [self._block(arm, set(live), at_break) for arm in (statement.body, statement.orelse)]
            return arms[0] | arms[1] | set(names(statement.test))
        if isinstance(statement, (For, While)):
            return self._loop(statement, live)
        if isinstance(statement, AugAssign):
            bound = {statement.target.id} if isinstance(statement.target, Name) else set()
            return live | set(names(statement)) | bound
        return (live - set(stored_names(statement))) | set(names(statement))

    def _loop(self, loop: AST, live: set[str]) -> set[str]:
        test = set(names(loop.iter if isinstance(loop, For) else loop.test))
        around = live | (set() if isinstance(loop, For) else test)
        while True:
            self._again.append(around)
            head = self._block(loop.body, set(around), live)
            self._again.pop()
            self.head[id(loop)] = head
            if head <= around:
                return around | test
            around = around | head
