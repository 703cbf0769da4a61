"""gains: within a run of statements a shadow's element gains once.

    u_bar[i] += u[i] * seed             ...
    ...                                 u_bar[i] += b * seed_2 + u[i] * seed
    u_bar[i] += b * seed_2

Sums commute: an earlier gain joins a later one of the same element if nothing between reads or overwrites the array.
Compilers cannot do it: for all they know a store to a shadow changes what the other gain reads.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

from s2sad.analyze.liveness import base_name, touched
from s2sad.blocks import with_blocks
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, FunctionDef, IfExp, Sub, Subscript, at, augment, call_name, dump,
    is_comment, names, placed, walk, with_body,
)

CHANGES_ROUNDING = True


def gains(function: FunctionDef) -> FunctionDef:
    """The function with its gains joined."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    run: list[AST] = []
    for statement in block:
        if _is_plain(statement):
            run.append(statement)
        else:
            made += _joined(run)
            run = []
            made.append(with_blocks(statement, _block))
    return made + _joined(run)


def _is_plain(statement: AST) -> bool:
    return is_comment(statement) or isinstance(statement, (Assign, AugAssign)) and not any(
        (call_name(n) or "").startswith("user.") for n in walk(statement))


@dataclass
class _Found:
    """A statement of a run: whether it is a gain, of which element and array, the names that it reads and writes, and
    whether it is a sum of gains, whose parts are not gone through again."""
    statement: AST
    is_gain: bool
    element: str
    array: str
    reads: set[str]
    stored: set[str]
    is_sum: bool = False


def _found(statement: AST) -> _Found:
    gain = _is_gain(statement)
    element, array = (dump(statement.target), base_name(statement.target)) if gain else ("", "")
    return _Found(statement, gain, element, array, set(names(statement)), touched(statement))


def _joined(run: list[AST]) -> list[AST]:
    found, position = [_found(s) for s in run], 0
    while position < len(found):
        first = found[position]
        later = _partner(found, position) if first.is_gain else None
        if later is None:
            position += 1
            continue
        found[later] = _both(first, found[later])
        del found[position]
    return [f.statement for f in found]


def _is_gain(statement: AST) -> bool:
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Subscript)
            and base_name(statement.target) not in names(statement.value)
            and not isinstance(statement.value, IfExp))


def _partner(run: list[_Found], position: int) -> int | None:
    """The next gain of the same element that a gain may join."""
    gain = run[position]
    for later in range(position + 1, len(run)):
        other = run[later]
        if other.is_gain and other.element == gain.element:
            return later
        touches = gain.array in other.reads or gain.array in other.stored
        if touches and not (other.is_gain and other.array == gain.array):
            return None
        if (other.stored - {gain.array}) & gain.reads:
            return None
    return None


def _both(first: _Found, second: _Found) -> _Found:
    """One gain for two, at the place of the second."""
    for gain in (first, second):
        if not gain.is_sum:
            at(gain.statement, second.statement)
    few, reads = sorted((first.reads, second.reads), key=len)
    reads |= few
    return replace(second, statement=_sum(first.statement, second.statement), reads=reads, is_sum=True)


def _sum(first: AugAssign, second: AugAssign) -> AST:
    """The statement, with the sign of the second."""
    op, left, right = second.op, second.value, first.value
    if isinstance(first.op, Sub) and isinstance(op, Add):
        sign: AST = Sub()
    elif isinstance(first.op, Add) and isinstance(op, Sub):
        op, left, right, sign = Add(), first.value, second.value, Sub()
    else:
        sign = Add()
    made = augment(second.target, op, placed(BinOp(left, sign, right), second))
    placed(made.target, second)
    return placed(made, second)
