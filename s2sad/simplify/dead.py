"""dead: statements whose results nothing reads are taken out, loops and branches that are empty then too.

Requires a structured function; establishes that what is left is read later, or is a guard or an effect.
This is what prunes the forward sweep to what the reverse sweep reads (adjoint liveness: Hascoet, Araya-Polo, 2005).
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.analyze.liveness import Liveness, Writes, targets
from s2sad.blocks import with_blocks
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Break, Call, Expr, For, FunctionDef, If, Name, Not, Raise, Return, UnaryOp,
    While, at, copy, forgotten, is_comment, walk,
)


def dead(function: FunctionDef, live_out: set[str], writes: Writes, pure: Callable[[Call], bool],
         unread: Callable[[Call], set[str]] = lambda call: set()) -> FunctionDef:
    """The function without dead statements; `live_out` are the arrays that the caller reads."""
    while True:
        live = Liveness(function, live_out, writes, pure, unread=unread)
        new = copy(function)
        pruned = _Dead(live).block(function.body)
        new.body = pruned
        if _count(new) == _count(function):
            return new
        function = new


def _count(function: FunctionDef) -> int:
    return sum(1 for _ in walk(function))


class _Dead:
    def __init__(self, live: Liveness):
        self.live = live

    def block(self, block: list[AST]) -> list[AST]:
        kept: list[AST] = []
        for statement in block:
            kept += self.statement(statement)
        return kept

    def statement(self, statement: AST) -> list[AST]:
        if is_comment(statement) or forgotten(statement) or isinstance(statement, (Assert, Raise, Return, Break)):
            return [statement]
        after = self.live.after[id(statement)]
        if isinstance(statement, (For, While)):
            if id(statement) in self.live.idle:
                return []
            new = with_blocks(statement, self.block)
            return [new] if _does_anything(new.body) else []
        if isinstance(statement, If):
            return branch(with_blocks(statement, self.block))
        if isinstance(statement, (Assign, AugAssign, Expr)) and self.live.needed(statement, after):
            if isinstance(statement, Assign) and isinstance(statement.value, Name) and targets(statement)[0:1] and \
                    isinstance(targets(statement)[0], Name) and targets(statement)[0].id == statement.value.id:
                return []
            return [statement]
        return []


def _does_anything(body: list[AST]) -> bool:
    """Whether a loop's body does more than to leave the loop."""
    return any(_does_anything([*s.body, *s.orelse]) if isinstance(s, If) else
               not is_comment(s) and not forgotten(s) and not isinstance(s, Break)
               for s in body)


def branch(statement: If) -> list[AST]:
    """A branch with no empty body."""
    if not statement.body and not statement.orelse:
        return []
    if not statement.body:
        return [at(If(_opposite(statement.test), statement.orelse, []), statement)]
    return [statement]


def _opposite(test: AST) -> AST:
    if isinstance(test, UnaryOp) and isinstance(test.op, Not):
        return test.operand
    return UnaryOp(Not(), test)


