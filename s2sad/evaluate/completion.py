"""How control leaves statements, and which names are then bound for certain."""
from __future__ import annotations

from s2sad.tree import (
    AST, Break, Constant, Continue, For, If, Name, Raise, Return, Store, While, children, stored_names,
)

FALL, BREAK, CONTINUE, RETURN, RAISE = "fall", "break", "continue", "return", "raise"
_LEAVES = {Break: BREAK, Continue: CONTINUE, Return: RETURN, Raise: RAISE}


def completion(statements: list[AST]) -> frozenset[str]:
    """The ways in which control can leave: `fall` is over the end; breaks of inner loops stay inside."""
    found: frozenset[str] = frozenset({FALL})
    for statement in statements:
        found = (found - {FALL}) | _exits_of(statement)
        if FALL not in found:
            break
    return found


def endless(loop: AST) -> bool:
    """Whether only a jump ends the loop."""
    return isinstance(loop, While) and isinstance(loop.test, Constant) and bool(loop.test.value)


def _exits_of(node: AST) -> frozenset[str]:
    if type(node) in _LEAVES:
        return frozenset({_LEAVES[type(node)]})
    if isinstance(node, If):
        return completion(node.body) | completion(node.orelse)
    if not isinstance(node, (For, While)):
        return frozenset({FALL})
    inside = completion(node.body)
    found = inside & {RETURN, RAISE}
    if BREAK in inside:
        found |= {FALL}
    return found if endless(node) else found | completion(node.orelse)


def bound_after(statements: list[AST], before: frozenset[str]) -> frozenset[str] | None:
    """The names certainly bound after the statements (structured, without returns), None where that is never."""
    return _bound(statements, before, [])


def _bound(statements: list[AST], bound: frozenset[str] | None,
           at_breaks: list[frozenset[str]]) -> frozenset[str] | None:
    for node in statements:
        if bound is None:
            return None
        if isinstance(node, Break):
            at_breaks.append(bound)
            return None
        if isinstance(node, Raise):
            return None
        if isinstance(node, If):
            bound = _both(_bound(node.body, bound, at_breaks), _bound(node.orelse, bound, at_breaks))
        elif isinstance(node, (For, While)):
            inner: list[frozenset[str]] = []
            target = stored_names(node.target) if isinstance(node, For) else []
            _bound(node.body, bound | set(target), inner)
            bound = None if endless(node) else bound
            for state in inner:
                bound = _both(bound, state)
        else:
            bound = bound | set(_names_bound(node))
    return bound


def _both(a: frozenset[str] | None, b: frozenset[str] | None) -> frozenset[str] | None:
    return b if a is None else a if b is None else a & b


def _names_bound(node: AST) -> list[str]:
    return [n.id for child in children(node) for n in _targets(child) if isinstance(n.ctx, Store)]


def _targets(node: AST) -> list[Name]:
    if isinstance(node, Name):
        return [node]
    return [n for child in getattr(node, "elts", []) for n in _targets(child)]
