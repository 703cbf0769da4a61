"""local_imports: what a function imports itself is as if the code around it had imported it.

    def f(u):                           def f(u):
        import numpy as np                  return np.sum(u)
        return np.sum(u)

Requires a captured function; its scope has what is imported. An import in a branch or a loop stays, to be refused, as
does one of a name that the function binds otherwise, too.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from s2sad import tree
from s2sad.read.outside_values import AST, Captured, Meaning, Surroundings
from s2sad.tree import FunctionDef

_IMPORTS = ("Import", "ImportFrom")


class _WithImports:
    """The names around a function, and what it imports itself."""

    def __init__(self, scope: Surroundings, own: Mapping[str, Meaning]):
        self.scope, self.own = scope, own

    def lookup(self, name: str) -> Meaning | None:
        return self.own.get(name) or self.scope.lookup(name)

    def known(self) -> list[str]:
        return [*self.own, *self.scope.known()]

    def imported(self, module: str, level: int, name: str | None) -> Meaning:
        return self.scope.imported(module, level, name)


def local_imports(captured: Captured) -> Captured:
    """The function without its own imports, which its scope has instead."""
    function = captured.tree
    if not isinstance(function, FunctionDef) or not any(map(_is_import, function.body)):
        return captured
    bound = {n.id for n in tree.walk([function.args, *function.body]) if isinstance(n, tree.Name)
             and not isinstance(n.ctx, tree.Load)} | {s.name for s in function.body if hasattr(s, "name")}
    found: dict[str, Meaning] = {}
    kept: list[AST] = []
    for statement in function.body:
        meanings = _meanings(statement, captured) if _is_import(statement) else {}
        if not meanings or meanings.keys() & bound:
            kept.append(statement)
        else:
            found |= meanings
    new = tree.copy(function)
    new.body = tree.copy(kept) or [tree.at(tree.Pass(), function)]
    return replace(captured, tree=new, scope=_WithImports(captured.scope, found))


def _is_import(statement: AST) -> bool:
    return type(statement).__name__ in _IMPORTS


def _meanings(statement: AST, captured: Captured) -> dict[str, Meaning]:
    """What an import binds: `import a.b` binds a, from which b is reached."""
    found = {}
    for alias in statement.names:
        if type(statement).__name__ == "ImportFrom":
            found[alias.asname or alias.name] = captured.scope.imported(
                statement.module or "", statement.level or 0, alias.name)
        elif alias.asname:
            found[alias.asname] = captured.scope.imported(alias.name, 0, None)
        else:
            first = alias.name.partition(".")[0]
            captured.scope.imported(alias.name, 0, None)
            found[first] = captured.scope.imported(first, 0, None)
    return found
