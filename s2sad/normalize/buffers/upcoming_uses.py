"""upcoming_uses: which names may be read or stored into later: the array that such a name stands for must be kept.

Requires structured form; establishes, for every statement, the names that are used after it before they are bound anew.
"""
from __future__ import annotations

from s2sad.tree import AST, AugAssign, Break, For, FunctionDef, If, Name, While, names, stored_names


class UpcomingUses:
    """The table: `after[id(statement)]` and, for loops, `head[id(loop)]`, the names used from where the body begins."""

    def __init__(self, function: FunctionDef):
        self.after: dict[int, set[str]] = {}
        self.head: dict[int, set[str]] = {}
        self._block(function.body, set(), set())

    def _block(self, block: list[AST], live: set[str], at_break: set[str]) -> set[str]:
        for statement in reversed(block):
            self.after[id(statement)] = set(live)
            live = self._statement(statement, live, at_break)
        return live

    def _statement(self, statement: AST, live: set[str], at_break: set[str]) -> set[str]:
        if isinstance(statement, Break):
            return set(at_break)
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
            head = self._block(loop.body, set(around), live)
            self.head[id(loop)] = head
            if head <= around:
                return around | test
            around = around | head
