"""Lists of the residual program that nothing reads: histories that are kept for a picture.

    history = []                                 while t < end:
    while t < end:                     ->            u = step(u)
        u = step(u)
        history.append(u.copy())
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from s2sad.blocks import with_blocks
from s2sad.tree import AST, Assign, Attribute, Call, Expr, List, Name, walk


def without_unread_lists(block: Sequence[AST]) -> list[AST]:
    """The statements without lists that are made, appended to, and never read."""
    uses = Counter(n.id for s in block for n in walk(s) if isinstance(n, Name))
    own = Counter(name for s in block for n in walk(s) for name in [_made(n) or _appended(n)] if name)
    made = {name for s in block for n in walk(s) if (name := _made(n))}
    unread = {name for name in made if uses[name] == own[name]}

    def change(statements: list[AST]) -> list[AST]:
        return [with_blocks(s, change) for s in statements if (_made(s) or _appended(s)) not in unread]
    return change(list(block)) if unread else list(block)


def _made(node: Any) -> str:
    """The list that a statement makes."""
    if isinstance(node, Assign) and isinstance(node.value, List) and isinstance(node.targets[0], Name):
        return node.targets[0].id
    return ""


def _appended(node: Any) -> str:
    """The list that a statement appends to."""
    call = node.value if isinstance(node, Expr) else None
    if isinstance(call, Call) and isinstance(call.func, Attribute) and call.func.attr == "append" and isinstance(
            call.func.value, Name):
        return call.func.value.id
    return ""
