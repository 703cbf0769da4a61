"""merge_branches: adjacent branches on one test become one, and a branch with two equal sides gives way to its side.

    if taken:                       if taken:
        a = f(x)                        a = f(x)
    if taken:                           b = g(a)
        b = g(a)
    else:                           else:
        b = 0.0                         b = 0.0

*Requires* a structured function. *Establishes* the same values: the first branch does not change what the test reads.
"""
from __future__ import annotations

from s2sad.liveness import base_name, targets
from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import AST, FunctionDef, If, Subscript, at, calls_kernel, equal, names, walk, with_body

CHANGES_ROUNDING = False


def merge_branches(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with its adjacent branches merged."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        before = made[-1] if made else None
        if isinstance(statement, If) and isinstance(before, If) and _tests_again(before, statement):
            made[-1] = at(If(before.test, [*before.body, *statement.body], [*before.orelse, *statement.orelse]), before)
        else:
            made.append(statement)
    found: list[AST] = []
    for statement in (with_blocks(s, _block) for s in made):
        alike = isinstance(statement, If) and equal_blocks(statement.body, statement.orelse)
        found += statement.body if alike and not calls_kernel(statement.test) else [statement]
    return found


def equal_blocks(first: list[AST], second: list[AST]) -> bool:
    return len(first) == len(second) and all(map(equal, first, second))


def _tests_again(first: If, second: If) -> bool:
    inside = list(walk([*first.body, *first.orelse]))
    if not equal(first.test, second.test) or calls_kernel(first.test) or any(map(_leaves_block, inside)):
        return False
    elements = any(isinstance(n, Subscript) for n in walk(first.test))
    written = {base_name(t) for s in inside for t in targets(s)}
    return not written & set(names(first.test)) and not (elements and any(map(calls_kernel, inside)))


def _leaves_block(node: AST) -> bool:
    return type(node).__name__ in ("Break", "Continue", "Return", "Raise", "Assert")
