"""Going through the blocks of a function: one place that knows which statements hold blocks."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.tree import AST, For, If, Return, Tuple, While, at

Blocks = Callable[[list[AST]], list[AST]]


def with_blocks(statement: AST, change: Blocks) -> AST:
    """The statement with every block below it changed; one without blocks is itself."""
    if isinstance(statement, For):
        return at(For(statement.target, statement.iter, change(statement.body), [], None), statement)
    if isinstance(statement, While):
        return at(While(statement.test, change(statement.body), []), statement)
    if isinstance(statement, If):
        return at(If(statement.test, change(statement.body), change(statement.orelse)), statement)
    return statement


def heads(statement: AST) -> list[AST]:
    """The expressions of a statement itself, without its blocks."""
    if isinstance(statement, (If, While)):
        return [statement.test]
    return [statement.iter] if isinstance(statement, For) else [statement]




def returned_values(block: list[AST]) -> list[AST]:
    """What a function returns in its last statement, one after the other."""
    last = block[-1] if block else None
    if not isinstance(last, Return) or last.value is None:
        return []
    return list(last.value.elts) if isinstance(last.value, Tuple) else [last.value]
