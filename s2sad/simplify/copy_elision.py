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

or is the shadow, where nothing mentions that afterwards. *Requires* a structured function; under Numba the stores are
loops. *Establishes* the same values: no statement in between mentions the shadow, and no name keeps a view of it.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from s2sad.blocks import with_blocks
from s2sad.infer.types import Type
from s2sad.simplify.context import DerivativeContext
from s2sad.tree import (
    AST, Assign, Attribute, AugAssign, BinOp, BoolOp, Call, Compare, Constant, For, FunctionDef, Name, Subscript,
    UnaryOp, assign, attribute, call, call_name, calls_kernel, const, dump, index, is_comment, name, names, rename,
    walk, walk_statements, with_body,
)

CHANGES_ROUNDING = False

_ALLOCATING = {"numpy.zeros", "numpy.zeros_like", "numpy.empty", "numpy.empty_like", "numpy.where", "numpy.sum",
               "numpy.outer", "numpy.copy", "numpy.matmul", "numpy.exp", "runtime.strong_zero"}


def copy_elision(function: FunctionDef, context: DerivativeContext) -> FunctionDef:
    """The function without such copies."""
    mentions = Counter(n.id for n in walk(function) if isinstance(n, Name))

    def block(given: list[AST]) -> list[AST]:
        made = [with_blocks(s, block) for s in given]
        position = 0
        while position < len(made):
            shorter = _elide_copy(made, position, mentions)
            made, position = shorter or made, position + (shorter is None)
        return made
    return with_body(function, _without_last_copies(block(function.body), {p.id for p in function.args.args},
                                                    context.types))


def _without_last_copies(block: list[AST], parameters: set[str], types: Mapping[str, Type]) -> list[AST]:
    """The body of a function, where the copy of an array that nothing mentions any more is that array."""
    position = 0
    while position < len(block):
        taken, before, behind = block[position], block[:position], block[position + 1:]
        copied = _copied(taken)
        if copied is not None and not {*copied} & parameters and copied[1] not in names([*behind]) and copied[
                0] not in {n.id for n in walk(before) if isinstance(n, Name)} and all(
                _keeps_no_view(s) or _makes_numbers_of(s, copied[1], types) for s in before if copied[1] in names(s)):
            block = [*before, *(rename(s, {copied[0]: copied[1]}) for s in behind)]
        else:
            position += 1
    return block


def _copied(statement: AST) -> tuple[str, str] | None:
    """The name of a copy, and that of the array that it is one of."""
    if not isinstance(statement, Assign) or call_name(statement.value) != "numpy.copy" or not isinstance(
            target := statement.targets[0], Name) or not isinstance(array := statement.value.args[0], Name):
        return None
    return target.id, array.id


def _makes_numbers_of(statement: AST, array: str, types: Mapping[str, Type]) -> bool:
    """Whether no name is bound to what is made of an array, unless to a number, and no kernel is called."""
    made = [t.id for s in walk_statements([statement]) if isinstance(s, Assign) and array in names(s.value)
            for t in s.targets if isinstance(t, Name)]
    return all(n in types and types[n].is_number for n in made) and not calls_kernel(statement)


def _elide_copy(block: list[AST], position: int, mentions: Counter[str]) -> list[AST] | None:
    """The block without the copy at a position, None if the copy must be made."""
    copied = _copied(block[position])
    if copied is None:
        return None
    seed, array = copied
    cleared = next((k for k in range(position + 1, len(block)) if not is_comment(block[k])), None)
    if cleared is None or not _is_clear(block[cleared], array):
        return None
    users = [k for k in range(cleared + 1, len(block)) if seed in names(block[k])]
    between = block[cleared + 1:users[-1] + 1] if users else []
    if not users or array in names(between) or 1 + _occurrences(between, seed) != mentions[seed] or not all(
            _keeps_no_view(block[k]) for k in users):
        return None
    mentions[array] += mentions.pop(seed) - 2
    return [*block[:position], *block[position + 1:cleared], *(rename(s, {seed: array}) for s in between),
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
