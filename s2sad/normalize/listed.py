"""listed: what a list holds is a copy here, in Python's list the array itself; where that would tell, it is refused.

    for k in range(n):                  for k in range(n):
        w = np.zeros(2)                     us.append(x)
        w[0] = x[k]                         x[0] = 0.0          refused: Python's list holds the new x
        us.append(w)    as good as a copy
"""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.infer.infer import Typing
from s2sad.normalize.lasting import own_parts
from s2sad.normalize.memory import Memory, fresh_value
from s2sad.normalize.viewing import SHOWN
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, FunctionDef, If, Name, Store, Subscript, call_name, const, index, rename, walk,
)


def told_apart(function: FunctionDef, stores: Sequence[AST], typing: Typing, memory: Memory) -> list[AST]:
    """The stores of an array into a list after which the array may be written by a name of its own."""
    appended = {id(s) for s in stores}
    every = [p for p in own_parts(function.body) if id(p) not in appended]
    found = []
    for store in stores:
        value = store.value
        shared = isinstance(value, (Name, Subscript, Attribute)) or call_name(value) in SHOWN
        if not shared or not typing.of(value).is_array:
            continue
        made = {id(p) for p in own_parts(_made(function.body, store))}
        outside = memory.written([p for p in every if id(p) not in made])
        by_others = memory.written([rename(p, {value.id: f"{value.id}."}) for p in every if id(p) in made])
        if memory.affected(index(value, const(0)), outside | by_others):
            found.append(store)
    return found


def _made(block: list[AST], store: AST) -> list[AST]:
    """The statements from the one that makes an array anew to its store, in one turn; none if it is not made so."""
    found = _before(block, store) if isinstance(store.value, Name) else None
    return found[1] if found is not None and found[0] else []


def _before(block: list[AST], store: AST) -> tuple[bool, list[AST]] | None:
    """Whether what binds the array's name was found, and the statements since then; None if the store is not here."""
    for position, statement in enumerate(block):
        if statement is store:
            return _since(block[:position], store.value.id)
        for field in ("body", "orelse"):
            found = _before(getattr(statement, field, []), store)
            if found is not None and (found[0] or not isinstance(statement, If)):
                return found if found[0] else (True, [])
            if found is not None:
                bound, statements = _since(block[:position], store.value.id)
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
