"""branches: neighbours that ask the same question are one branch, and one whose two ways are the same is none.

    if taken:                       if taken:
        a = f(x)                        a = f(x)
    if taken:                           b = g(a)
        b = g(a)
    else:                           else:
        b = 0.0                         b = 0.0

Requires a structured function; a question is asked once only where the first answer does not change it.
"""
from __future__ import annotations

from s2sad.analyze.liveness import base_name, targets
from s2sad.blocks import with_blocks
from s2sad.tree import AST, FunctionDef, If, Subscript, at, call_name, equal, names, walk, with_body

CHANGES_ROUNDING = False


def branches(function: FunctionDef) -> FunctionDef:
    """The function with its neighbouring branches joined."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        before = made[-1] if made else None
        if isinstance(statement, If) and isinstance(before, If) and _asks_again(before, statement):
            made[-1] = at(If(before.test, [*before.body, *statement.body], [*before.orelse, *statement.orelse]), before)
        else:
            made.append(statement)
    found: list[AST] = []
    for statement in (with_blocks(s, _block) for s in made):
        alike = isinstance(statement, If) and equal_blocks(statement.body, statement.orelse)
        found += statement.body if alike and not _calls(statement.test) else [statement]
    return found


def equal_blocks(first: list[AST], second: list[AST]) -> bool:
    return len(first) == len(second) and all(map(equal, first, second))


def _asks_again(first: If, second: If) -> bool:
    inside = list(walk([*first.body, *first.orelse]))
    if not equal(first.test, second.test) or _calls(first.test) or any(map(_leaves, inside)):
        return False
    elements = any(isinstance(n, Subscript) for n in walk(first.test))
    written = {base_name(t) for s in inside for t in targets(s)}
    return not written & set(names(first.test)) and not (elements and any(map(_calls, inside)))


def _calls(node: AST) -> bool:
    """Whether a kernel is called, which may write its arguments or raise."""
    return any((call_name(n) or "").startswith("user.") for n in walk(node))


def _leaves(node: AST) -> bool:
    return type(node).__name__ in ("Break", "Continue", "Return", "Raise", "Assert")
