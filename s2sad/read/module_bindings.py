"""Which names the statements of a module bind, and what they change.
"""
from __future__ import annotations

from s2sad import tree
from s2sad.read.outside_values import AST


def changed_name(node: AST) -> str:
    """The name of what a statement stores an item in, or calls a method of that may change it."""
    is_store = isinstance(node, (tree.Subscript, tree.Attribute)) and not isinstance(node.ctx, tree.Load)
    base = node if is_store else node.value.func if isinstance(node, tree.Expr) and isinstance(
        node.value, tree.Call) and isinstance(node.value.func, tree.Attribute) else None
    while isinstance(base, (tree.Subscript, tree.Attribute)):
        base = base.value
    return base.id if isinstance(base, tree.Name) else ""


def bound_twice(body: list[AST]) -> frozenset[str]:
    """The names that statements may bind more than once."""
    found = [n for s in body for n in bound_names(s)]
    return frozenset(n for n in found if found.count(n) > 1)


def imports_name(statement: AST, name: str) -> bool:
    return any((alias.asname or alias.name.partition(".")[0]) == name for alias in statement.names)


def bound_names(node: AST) -> list[str]:
    """The names that a statement may bind in its module, at any depth outside functions."""
    kind = type(node).__name__
    if kind in ("FunctionDef", "AsyncFunctionDef", "ClassDef"):
        return [node.name]
    if kind in ("Import", "ImportFrom"):
        return [alias.asname or alias.name.partition(".")[0] for alias in node.names]
    if isinstance(node, tree.Name):
        return [node.id] if isinstance(node.ctx, tree.Store) else []
    return [name for child in tree.children(node) for name in bound_names(child)]
