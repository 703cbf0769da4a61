"""merge: a zero and the first addition to it become one binding, neighbouring branches with one test one branch.

    y_bar = 0.0                     y_bar = a * x_bar
    y_bar += a * x_bar
    if taken: z = x[i]              if taken:
    if taken: w = z * z                 z = x[i]
                                        w = z * z
"""
from __future__ import annotations

from s2sad.analyze.liveness import base_name, touched
from s2sad.blocks import with_blocks
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Break, Constant, FunctionDef, If, Name, Return, Store, Sub, Subscript, assign, at,
    call_name, dump, names, negate, walk, with_body,
)

CHANGES_ROUNDING = False


def merge(function: FunctionDef) -> FunctionDef:
    """The function with zeros merged."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    block = [with_blocks(s, _block) for s in block]
    if not any(_is_zero(s) or _is_cleared(s) for s in block):
        return _joined(block)
    mentioned = [_mentioned(s) for s in block]
    position = 0
    while position < len(block):
        statement = block[position]
        if _is_zero(statement):
            user = _first(mentioned, position + 1, statement.targets[0].id)
            if user is not None and _adds(block[user], statement.targets[0].id):
                block[user] = _bound(block[user])
                del block[position], mentioned[position]
                continue
        elif _is_cleared(statement):
            _refill(block, mentioned, position)
        position += 1
    return _joined(block)


def _mentioned(statement: AST) -> set[str]:
    return {n.id for n in walk(statement) if isinstance(n, Name)}


def _first(mentioned: list[set[str]], start: int, identifier: str) -> int | None:
    """Where a name is mentioned first from a place of a block on."""
    return next((k for k in range(start, len(mentioned)) if identifier in mentioned[k]), None)


def _is_cleared(statement: AST) -> bool:
    """Whether an element of an array is set to zero."""
    return (isinstance(statement, Assign) and isinstance(statement.targets[0], Subscript)
            and isinstance(statement.value, Constant) and type(statement.value.value) is float
            and statement.value.value == 0.0)


def _refill(block: list[AST], mentioned: list[set[str]], position: int) -> None:
    """Binds a cleared element of a block that gains again to the gain: before all other gains of its array, which may
    be to the same element."""
    place = block[position].targets[0]
    array = base_name(place)
    first = _first(mentioned, position + 1, array)
    if first is None or set(names(place)) & {n for s in block[position + 1:first] for n in touched(s)}:
        return
    bound: set[str] = set()
    for k in range(first, len(block)):
        item = block[k]
        if array in mentioned[k]:
            if not _gains(item, array):
                return
            if dump(item.target) == dump(place):
                if bound & ({*names(item.value)} | {*names(place)}):
                    return
                del block[k], block[position], mentioned[position]
                block.insert(first - 1, at(assign(
                    place, item.value if isinstance(item.op, Add) else negate(item.value)), item))
                mentioned.insert(first - 1, mentioned.pop(k - 1))
                return
        elif not isinstance(item, (Assign, AugAssign)):
            return
        bound |= touched(item) - {array}


def _gains(statement: AST, array: str) -> bool:
    """Whether all that a statement does with an array is to add to an element of it."""
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Subscript)
            and base_name(statement.target) == array and array not in names(statement.value)
            and array not in names(statement.target.slice) and not _mentions_call(statement.value))


def _mentions_call(node: AST) -> bool:
    return any((call_name(n) or "").startswith("user.") for n in walk(node))


def _joined(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        last = made[-1] if made else None
        if isinstance(statement, If) and isinstance(last, If) and _same_test(last, statement):
            made[-1] = at(If(last.test, _joined([*last.body, *statement.body]),
                             _joined([*last.orelse, *statement.orelse])), last)
        else:
            made.append(statement)
    return made


def _same_test(a: If, b: If) -> bool:
    """Whether two branches have one test, a name that the first does not bind."""
    if not isinstance(a.test, Name) or not isinstance(b.test, Name) or a.test.id != b.test.id:
        return False
    inside = [n for s in [*a.body, *a.orelse] for n in walk(s)]
    return not any(isinstance(n, (Break, Return)) or isinstance(n, Name) and n.id == a.test.id
                   and isinstance(n.ctx, Store) for n in inside)


def _is_zero(statement: AST) -> bool:
    return (isinstance(statement, Assign) and isinstance(statement.targets[0], Name)
            and isinstance(statement.value, Constant) and type(statement.value.value) is float
            and statement.value.value == 0.0)


def _adds(statement: AST, identifier: str) -> bool:
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Name)
            and statement.target.id == identifier and isinstance(statement.op, (Add, Sub))
            and identifier not in names(statement.value))


def _bound(statement: AugAssign) -> AST:
    value = statement.value if isinstance(statement.op, Add) else negate(statement.value)
    return at(assign(statement.target.id, value), statement)
