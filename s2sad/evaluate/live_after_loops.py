"""Which names are read after each loop, in a tree without `continue`, with a single return."""
from __future__ import annotations

from s2sad.tree import AST, AugAssign, Break, For, If, Name, While, names, stored_names


def live_after_loops(statements: list[AST]) -> dict[int, set[str]]:
    """For each `for` statement, by its id, the names whose value at its end may be read later."""
    found: dict[int, set[str]] = {}
    _before(statements, set(), set(), found)
    return found


def _before(statements: list[AST], after: set[str], at_break: set[str], found: dict[int, set[str]]) -> set[str]:
    live = set(after)
    for node in reversed(statements):
        if isinstance(node, Break):
            live = set(at_break)
        elif isinstance(node, If):
            live = (_before(node.body, live, at_break, found) | _before(node.orelse, live, at_break, found)
                    | set(names(node.test)))
        elif isinstance(node, (For, While)):
            live = _before_loop(node, live, found)
        else:
            live = (live - _killed(node)) | set(names(node))
            if isinstance(node, AugAssign) and isinstance(node.target, Name):
                live.add(node.target.id)
    return live


def _before_loop(node: AST, after: set[str], found: dict[int, set[str]]) -> set[str]:
    bound = set(stored_names(node.target)) if isinstance(node, For) else set()
    head = after | (set() if isinstance(node, For) else set(names(node.test)))
    while True:
        inside = _before(node.body, head, after, found) - bound
        if isinstance(node, For):
            inside |= set(names(node.target))
        if inside <= head:
            break
        head = head | inside
    if isinstance(node, For):
        found[id(node)] = set(after)
        return head | set(names(node.iter))
    return head


def _killed(node: AST) -> set[str]:
    return set() if isinstance(node, AugAssign) else set(stored_names(node))
