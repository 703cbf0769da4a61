"""copy_elision: a seed that is a copy of a shadow is read from the shadow itself, which is cleared behind the last use.

    def f(a: float64[:], b: float64[:], w: float64[:]):
        w[:] = a * b

in its adjoint:

    def f_adjoint(...):             def f_adjoint(...):
        ...                             ...
        seed = np.copy(w_bar)           a_bar[...] += b * w_bar
        w_bar[...] = 0.0                b_bar[...] += a * w_bar
        a_bar[...] += b * seed          w_bar[...] = 0.0
        b_bar[...] += a * seed

*Requires* a structured function; under Numba the stores are loops. *Establishes* the same values: no statement in
between mentions the shadow, and no name keeps a view of it.
"""
from __future__ import annotations

from collections import Counter

from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, BoolOp, Call, Compare, Constant, For, FunctionDef, Name, Subscript,
    UnaryOp, assign, attribute, call, call_name, const, dump, index, is_comment, name, names, rename, walk,
    walk_statements, with_body,
)

CHANGES_ROUNDING = False

_ALLOCATING = {"numpy.where", "numpy.sum", "numpy.outer", "numpy.copy", "numpy.matmul", "numpy.exp",
               "runtime.strong_zero"}


def copy_elision(function: FunctionDef, context: Context) -> FunctionDef:
    """The function without such copies."""
    mentions = Counter(n.id for n in walk(function) if isinstance(n, Name))

    def block(given: list[AST]) -> list[AST]:
        made = [with_blocks(s, block) for s in given]
        position = 0
        while position < len(made):
            shorter = _elide_copy(made, position, mentions)
            made, position = shorter or made, position + (shorter is None)
        return made
    return with_body(function, block(function.body))


def _elide_copy(block: list[AST], position: int, mentions: Counter[str]) -> list[AST] | None:
    """The block without the copy at a position, None if the copy must be made."""
    taken = block[position]
    if not isinstance(taken, Assign) or call_name(taken.value) != "numpy.copy" or not isinstance(
            taken.targets[0], Name) or not isinstance(array := taken.value.args[0], Name):
        return None
    seed = taken.targets[0].id
    cleared = next((k for k in range(position + 1, len(block)) if not is_comment(block[k])), None)
    if cleared is None or not _is_clear(block[cleared], array.id):
        return None
    users = [k for k in range(cleared + 1, len(block)) if seed in names(block[k])]
    between = block[cleared + 1:users[-1] + 1] if users else []
    if not users or array.id in names(between) or 1 + _occurrences(between, seed) != mentions[seed] or not all(
            _keeps_no_view(block[k]) for k in users):
        return None
    mentions[array.id] += mentions.pop(seed) - 2
    return [*block[:position], *block[position + 1:cleared], *(rename(s, {seed: array.id}) for s in between),
            block[cleared], *block[users[-1] + 1:]]


def _occurrences(block: list[AST], identifier: str) -> int:
    return sum(isinstance(n, Name) and n.id == identifier for n in walk(block))


def _is_clear(statement: AST, array: str) -> bool:
    """Whether a statement stores 0 into all of an array: at once, or in loops over all of its axes."""
    counters: list[str] = []
    while isinstance(statement, For) and len(statement.body) == 1 and dump(statement.iter) == dump(call(
            "builtins.range", index(attribute(name(array), "shape"), const(len(counters))))):
        counters.append(statement.target.id)
        statement = statement.body[0]
    if counters:
        whole = isinstance(statement, Assign) and dump(statement.targets[0]) == dump(
            assign(index(name(array), *map(name, counters)), const(0.0)).targets[0])
        return whole and isinstance(statement.value, Constant) and statement.value.value == 0.0
    if not isinstance(statement, Assign) or not isinstance(target := statement.targets[0], Subscript):
        return False
    whole = isinstance(target.slice, Constant) and target.slice.value is ...
    return whole and isinstance(target.value, Name) and target.value.id == array and isinstance(
        statement.value, Constant) and statement.value.value == 0.0


def _keeps_no_view(statement: AST) -> bool:
    """Whether a statement keeps no view of what it reads."""
    if isinstance(statement, AugAssign) or isinstance(statement, For) and all(
            isinstance(n.targets[0], Subscript) for n in walk_statements(statement.body) if isinstance(n, Assign)):
        return True
    if not isinstance(statement, Assign):
        return False
    value = statement.value
    return isinstance(statement.targets[0], Subscript) and not isinstance(value, (Name, Attribute)) or isinstance(
        value, (BinOp, BoolOp, UnaryOp, Compare)) or isinstance(value, Call) and call_name(value) in _ALLOCATING


__all__ = ["copy_elision"]
