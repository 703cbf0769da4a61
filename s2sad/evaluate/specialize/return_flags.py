"""return_flags: returns from inside loops become a flag, a break and one return behind the loop.

    for k in range(n):                 returned = False
        if x[k] > 1.0:                 for k in range(n):
            return x[k]         ->         if x[k] > 1.0:
    return x[0]                                result, returned = x[k], True
                                               break
                                       if returned:
                                           return result
                                       return x[0]
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from s2sad import tree
from s2sad.tree import AST

RETURNED, RESULT = ".returned", ".result"       # names that no kernel can have


def return_flags(definition: Any) -> list[AST]:
    """The body of a function in which only what is outside of loops returns."""
    return _block(definition.body, None)


def _block(block: Sequence[Any], loop: AST | None) -> list[AST]:
    found: list[AST] = []
    for s in block:
        found += _statement(s, loop)
    return found


def _statement(s: Any, loop: AST | None) -> list[AST]:
    kind = type(s).__name__
    if kind in ("FunctionDef", "ClassDef") or not _returns(s):
        return [s]
    if kind == "Return":
        return [s] if loop is None else [
            tree.at(n, s) for n in (tree.assign(RESULT, s.value or tree.const(None)),
                                    tree.assign(RETURNED, tree.const(True)), tree.Break())]
    is_loop = kind in ("For", "While")
    fields = {name: _block(getattr(s, name), s if is_loop and name == "body" else loop)
              for name in ("body", "orelse", "finalbody") if getattr(s, name, None)}
    if kind == "Match":
        fields["cases"] = [_case(c, loop) for c in s.cases]
    made = tree.replica(s, lambda value, name: fields.get(name, value))
    if not is_loop:
        return [made]
    behind = tree.Break() if loop is not None else tree.Return(tree.name(RESULT))
    first = [tree.at(tree.assign(RETURNED, tree.const(False)), s)] if loop is None else []
    return [*first, made, tree.at(tree.If(tree.name(RETURNED), [behind], []), s)]


def _case(case: Any, loop: AST | None) -> AST:
    body = _block(case.body, loop)
    return tree.replica(case, lambda value, name: body if name == "body" else value)


def _returns(s: AST) -> bool:
    work: list[Any] = [s]
    while work:
        node = work.pop()
        kind = type(node).__name__
        if kind == "Return":
            return True
        if kind not in ("FunctionDef", "ClassDef", "Lambda"):
            work += tree.children(node)
    return False
