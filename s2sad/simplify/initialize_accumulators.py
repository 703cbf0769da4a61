"""initialize_accumulators: an accumulator that is set to zero and then incremented is initialized with the increment.

    def f(x, y):
        return x * y

in its adjoint:

    def f_adjoint(x, y, result_bar):    def f_adjoint(x, y, result_bar):
        x_bar = 0.0                         result_bar_2 = result_bar
        y_bar = 0.0                         x_bar = y * result_bar_2
        result_bar_2 = 0.0                  y_bar = x * result_bar_2
        result_bar_2 += result_bar          return x_bar, y_bar
        x_bar += y * result_bar_2
        y_bar += x * result_bar_2
        return x_bar, y_bar

*Requires* a structured function. *Establishes* the same values; adjacent branches on one flag, which such zeros
separated, are one.
"""
from __future__ import annotations

from s2sad.liveness import base_name, touched
from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Break, Constant, FunctionDef, If, Name, Return, Store, Sub, Subscript, assign, at,
    calls_kernel, dump, names, negate, walk, with_body,
)

CHANGES_ROUNDING = False


def initialize_accumulators(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with its accumulators initialized."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    block = [with_blocks(s, _block) for s in block]
    if not any(_binds_zero(s) or clears_element(s) for s in block):
        return _merge_branches(block)
    mentioned = [_mentioned_names(s) for s in block]
    position = 0
    while position < len(block):
        statement = block[position]
        if _binds_zero(statement):
            user = _first_mention(mentioned, position + 1, statement.targets[0].id)
            if user is not None and _adds_to(block[user], statement.targets[0].id):
                block[user] = _as_binding(block[user])
                del block[position], mentioned[position]
                continue
        elif clears_element(statement):
            _initialize_element(block, mentioned, position)
        position += 1
    return _merge_branches(block)


def _mentioned_names(statement: AST) -> set[str]:
    return {n.id for n in walk(statement) if isinstance(n, Name)}


def _first_mention(mentioned: list[set[str]], start: int, identifier: str) -> int | None:
    """The position of the first statement from `start` on that mentions a name."""
    return next((k for k in range(start, len(mentioned)) if identifier in mentioned[k]), None)


def clears_element(statement: AST) -> bool:
    """Whether an element of an array is set to zero."""
    return (isinstance(statement, Assign) and isinstance(statement.targets[0], Subscript)
            and isinstance(statement.value, Constant) and type(statement.value.value) is float
            and statement.value.value == 0.0)


def _initialize_element(block: list[AST], mentioned: list[set[str]], position: int) -> None:
    """Stores the increment of a cleared element in place of the zero: before all other increments of the array, which
    may be of the same element."""
    place = block[position].targets[0]
    array = base_name(place)
    first = _first_mention(mentioned, position + 1, array)
    if first is None or set(names(place)) & {n for s in block[position + 1:first] for n in touched(s)}:
        return
    bound: set[str] = set()
    for k in range(first, len(block)):
        item = block[k]
        if array in mentioned[k]:
            if not _is_increment_of(item, array):
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


def _is_increment_of(statement: AST, array: str) -> bool:
    """Whether a statement mentions an array only to increment an element of it."""
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Subscript)
            and base_name(statement.target) == array and array not in names(statement.value)
            and array not in names(statement.target.slice) and not calls_kernel(statement.value))


def _merge_branches(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    for statement in block:
        last = made[-1] if made else None
        if isinstance(statement, If) and isinstance(last, If) and _same_test(last, statement):
            made[-1] = at(If(last.test, _merge_branches([*last.body, *statement.body]),
                             _merge_branches([*last.orelse, *statement.orelse])), last)
        else:
            made.append(statement)
    return made


def _same_test(a: If, b: If) -> bool:
    """Whether two branches test one name, which the first does not bind."""
    if not isinstance(a.test, Name) or not isinstance(b.test, Name) or a.test.id != b.test.id:
        return False
    inside = [n for s in [*a.body, *a.orelse] for n in walk(s)]
    return not any(isinstance(n, (Break, Return)) or isinstance(n, Name) and n.id == a.test.id
                   and isinstance(n.ctx, Store) for n in inside)


def _binds_zero(statement: AST) -> bool:
    return (isinstance(statement, Assign) and isinstance(statement.targets[0], Name)
            and isinstance(statement.value, Constant) and type(statement.value.value) is float
            and statement.value.value == 0.0)


def _adds_to(statement: AST, identifier: str) -> bool:
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Name)
            and statement.target.id == identifier and isinstance(statement.op, (Add, Sub))
            and identifier not in names(statement.value))


def _as_binding(statement: AugAssign) -> AST:
    value = statement.value if isinstance(statement.op, Add) else negate(statement.value)
    return at(assign(statement.target.id, value), statement)
