"""dead_code: statements whose results nothing reads are eliminated, and loops and branches that are then empty.

    def f(x):
        s = np.sin(x)
        return s + x

in its tangent:

    def f_tangent(x, x_dot):            def f_tangent(x, x_dot):
        s = np.sin(x)                       s_dot = np.cos(x) * x_dot
        s_dot = np.cos(x) * x_dot           result_dot = s_dot + x_dot
        result = s + x                      return (result_dot,)
        result_dot = s_dot + x_dot
        return (result_dot,)

*Requires* a structured function. *Establishes* that what a statement computes is live behind it, or that it is a guard
or an effect. This prunes the forward sweep to what the reverse sweep reads (adjoint liveness: Hascoet, Araya-Polo,
2005).
"""
from __future__ import annotations

from s2sad.liveness import Accesses, Liveness, targets
from s2sad.blocks import with_blocks
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assert, Assign, AugAssign, Break, Expr, For, FunctionDef, If, Name, Not, Raise, Return, UnaryOp,
    While, at, forgotten, is_comment, with_body,
)


def dead_code(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function without dead statements."""
    effects = context.effects
    accesses = Accesses(effects.writes, effects.pure, effects.unread)
    while True:
        pruning = _DeadCode(Liveness(function, context.live_out, accesses))
        function = with_body(function, pruning.block(function.body))
        if not pruning.changed:
            return function


class _DeadCode:
    """One round; `changed` says whether anything was dead."""

    def __init__(self, live: Liveness):
        self.live = live
        self.changed = False

    def block(self, block: list[AST]) -> list[AST]:
        kept: list[AST] = []
        for statement in block:
            left = self.statement(statement)
            self.changed = self.changed or not left
            kept += left
        return kept

    def statement(self, statement: AST) -> list[AST]:
        if is_comment(statement) or forgotten(statement) or isinstance(statement, (Assert, Raise, Return, Break)):
            return [statement]
        after = self.live.after[id(statement)]
        if isinstance(statement, (For, While)):
            if id(statement) in self.live.idle:
                return []
            new = with_blocks(statement, self.block)
            return [new] if _has_effect(new.body) else []
        if isinstance(statement, If):
            return without_empty_sides(with_blocks(statement, self.block))
        if isinstance(statement, (Assign, AugAssign, Expr)) and self.live.needed(statement, after):
            if isinstance(statement, Assign) and isinstance(statement.value, Name) and targets(statement)[0:1] and \
                    isinstance(targets(statement)[0], Name) and targets(statement)[0].id == statement.value.id:
                return []
            return [statement]
        return []


def _has_effect(body: list[AST]) -> bool:
    """Whether a loop's body does more than to leave the loop."""
    return any(_has_effect([*s.body, *s.orelse]) if isinstance(s, If) else
               not is_comment(s) and not forgotten(s) and not isinstance(s, Break)
               for s in body)


def without_empty_sides(statement: If) -> list[AST]:
    """The branch as statements: with its test negated where only the other side is left, none where neither is."""
    if not statement.body and not statement.orelse:
        return []
    if not statement.body:
        return [at(If(_negated(statement.test), statement.orelse, []), statement)]
    return [statement]


def _negated(test: AST) -> AST:
    if isinstance(test, UnaryOp) and isinstance(test.op, Not):
        return test.operand
    return UnaryOp(Not(), test)


