"""merge: a zero and the first addition to it become one binding, neighbouring branches with one test one branch.

    y_bar = 0.0                     y_bar = a * x_bar
    y_bar += a * x_bar
    if taken: z = x[i]              if taken:
    if taken: w = z * z                 z = x[i]
                                        w = z * z
"""
from __future__ import annotations

from s2sad.simplify.rebuild import with_blocks
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Break, Constant, FunctionDef, If, Name, Return, Store, Sub, assign, at, copy, names,
    negate, walk,
)


def merge(function: FunctionDef) -> FunctionDef:
    """The function with zeros merged."""
    new = copy(function)
    new.body = _block(function.body)
    return new


def _block(block: list[AST]) -> list[AST]:
    block = [with_blocks(s, _block) for s in block]
    position = 0
    while position < len(block):
        statement = block[position]
        if _is_zero(statement):
            user = next((k for k in range(position + 1, len(block)) if _mentions(block[k], statement.targets[0].id)),
                        None)
            if user is not None and _adds(block[user], statement.targets[0].id):
                block[user] = _bound(block[user])
                del block[position]
                continue
        position += 1
    return _joined(block)


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


def _mentions(statement: AST, identifier: str) -> bool:
    return any(isinstance(n, Name) and n.id == identifier for n in walk(statement))


def _adds(statement: AST, identifier: str) -> bool:
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Name)
            and statement.target.id == identifier and isinstance(statement.op, (Add, Sub))
            and identifier not in names(statement.value))


def _bound(statement: AugAssign) -> AST:
    value = statement.value if isinstance(statement.op, Add) else negate(statement.value)
    return at(assign(statement.target.id, value), statement)
