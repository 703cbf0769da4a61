"""copy_semantics: what a list holds is a copy here, in Python's list the array itself; where that would tell, it is
refused.

    for k in range(n):                  for k in range(n):
        w = np.zeros(2)                     us.append(x)
        w[0] = x[k]                         x[0] = 0.0          refused: Python's list holds the new x
        us.append(w)    as good as a copy
"""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.infer.inference import Typing
from s2sad.normalize.lists.capacity import own_parts
from s2sad.evaluate.effects import Memory, fresh_value
from s2sad.normalize.views.unsupported_views import shows
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, FunctionDef, If, Name, Store, Subscript, const, index, rename, walk,
)


def told_apart(function: FunctionDef, stores: Sequence[AST], typing: Typing, memory: Memory) -> list[AST]:
    """The stores of an array into a list after which the array may be written by a name of its own."""
    return [s for s in stores if is_shared(s.value, typing) and is_told(function, s, s.value, stores, memory)]


def is_shared(value: AST, typing: Typing) -> bool:
    """Whether a value is an array that something else may hold as well."""
    return (isinstance(value, (Name, Subscript, Attribute)) or shows(value)) and typing.of(value).is_array


def is_told(function: FunctionDef, store: AST, value: AST, stores: Sequence[AST], memory: Memory) -> bool:
    """Whether an array that a store puts into a list may be written after it by a name of its own."""
    appended = {id(s) for s in stores}
    every = [p for p in _not_before(function.body, store) if id(p) not in appended]
    made = {id(p) for p in own_parts(_made(function.body, store, value))}
    outside = memory.written([p for p in every if id(p) not in made])
    own = {value.id: f"{value.id}."} if isinstance(value, Name) else {}
    by_others = memory.written([rename(p, own) for p in every if id(p) in made])
    return memory.affected(index(value, const(0)), outside | by_others)


def _not_before(block: list[AST], store: AST) -> list[AST]:
    """What of the statements may come after a store; none if it is not here."""
    for position, statement in enumerate(block):
        if not any(n is store for n in walk(statement)):
            continue
        inside = [statement] if not isinstance(statement, If) else [
            n for arm in (statement.body, statement.orelse) for n in _not_before(arm, store)]
        return [*(own_parts(inside) if not isinstance(statement, If) else inside), *own_parts(block[position + 1:])]
    return []


def _made(block: list[AST], store: AST, value: AST) -> list[AST]:
    """The statements from the one that makes an array anew to its store, in one turn; none if it is not made so."""
    found = _before(block, store, value.id) if isinstance(value, Name) else None
    return found[1] if found is not None and found[0] else []


def _before(block: list[AST], store: AST, kept: str) -> tuple[bool, list[AST]] | None:
    """Whether what binds the array's name was found, and the statements since then; None if the store is not here."""
    for position, statement in enumerate(block):
        if statement is store:
            return _since(block[:position], kept)
        for field in ("body", "orelse"):
            found = _before(getattr(statement, field, []), store, kept)
            if found is not None and (found[0] or not isinstance(statement, If)):
                return found if found[0] else (True, [])
            if found is not None:
                bound, statements = _since(block[:position], kept)
                return (bound, [*statements, *found[1]]) if statements or not bound else (True, [])
    return None


def _since(before: list[AST], identifier: str) -> tuple[bool, list[AST]]:
    for position in range(len(before) - 1, -1, -1):
        statement = before[position]
        if _binds(statement, identifier):
            new = isinstance(statement, Assign) and isinstance(statement.targets[0], Name) and fresh_value(
                statement.value)
            return True, before[position:] if new else []
    return False, before


def _binds(statement: AST, identifier: str) -> bool:
    """Whether a statement binds a name to another array; `w += x` writes the one that it has."""
    added = {id(n.target) for n in walk(statement) if isinstance(n, AugAssign)}
    return any(isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store) and id(n) not in added
               for n in walk(statement))
