"""combine_increments: several increments of one element of a shadow in a straight-line run become one.

    def f(u: float64[:], y: float64[:], z: float64[:]):
        for i in range(y.size):
            y[i] = u[i] * u[i]
            z[i] = np.sin(u[i])

in its adjoint:

    def f_adjoint(...):                             def f_adjoint(...):
        for i in range(y.size):                         for i in range(y.size):
            seed = z_bar[i]                                 seed = z_bar[i]
            z_bar[i] = 0.0                                  z_bar[i] = 0.0
            u_bar[i] += np.cos(u[i]) * seed                 seed_2 = y_bar[i]
            seed_2 = y_bar[i]                               y_bar[i] = 0.0
            y_bar[i] = 0.0                                  u_bar[i] += 2.0 * (u[i] * seed_2) + np.cos(u[i]) * seed
            u_bar[i] += 2.0 * (u[i] * seed_2)

*Requires* a structured function. *Establishes* the same sums, reassociated: an increment joins the next one of the same
element if no statement in between reads or overwrites the array. A compiler cannot do it, since a store to the shadow
may alias what the other increment reads.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

from s2sad.liveness import base_name, touched
from s2sad.blocks import with_blocks
from s2sad.passes import Context
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, FunctionDef, IfExp, Sub, Subscript, at, augment, calls_kernel, dump, is_comment,
    names, placed, with_body,
)

CHANGES_ROUNDING = True


def combine_increments(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with its increments combined."""
    return with_body(function, _block(function.body))


def _block(block: list[AST]) -> list[AST]:
    made: list[AST] = []
    run: list[AST] = []
    for statement in block:
        if _is_straight_line(statement):
            run.append(statement)
        else:
            made += _combine(run)
            run = []
            made.append(with_blocks(statement, _block))
    return made + _combine(run)


def _is_straight_line(statement: AST) -> bool:
    return is_comment(statement) or isinstance(statement, (Assign, AugAssign)) and not (
        calls_kernel(statement))


@dataclass
class _RunStatement:
    """A statement of a run: whether it is an increment, of which element and array, the names that it reads and stores,
    and whether it is already the sum of several increments."""
    statement: AST
    is_increment: bool
    element: str
    array: str
    reads: set[str]
    stored: set[str]
    is_combined: bool = False


def _described(statement: AST) -> _RunStatement:
    increment = _is_increment(statement)
    element, array = (dump(statement.target), base_name(statement.target)) if increment else ("", "")
    return _RunStatement(statement, increment, element, array, set(names(statement)), touched(statement))


def _combine(run: list[AST]) -> list[AST]:
    found, position = [_described(s) for s in run], 0
    while position < len(found):
        first = found[position]
        later = _combinable(found, position) if first.is_increment else None
        if later is None:
            position += 1
            continue
        found[later] = _combined(first, found[later])
        del found[position]
    return [f.statement for f in found]


def _is_increment(statement: AST) -> bool:
    return (isinstance(statement, AugAssign) and isinstance(statement.target, Subscript)
            and base_name(statement.target) not in names(statement.value)
            and not isinstance(statement.value, IfExp))


def _combinable(run: list[_RunStatement], position: int) -> int | None:
    """The position of the next increment of the same element with which this one may be combined."""
    increment = run[position]
    for later in range(position + 1, len(run)):
        other = run[later]
        if other.is_increment and other.element == increment.element:
            return later
        touches = increment.array in other.reads or increment.array in other.stored
        if touches and not (other.is_increment and other.array == increment.array):
            return None
        if (other.stored - {increment.array}) & increment.reads:
            return None
    return None


def _combined(first: _RunStatement, second: _RunStatement) -> _RunStatement:
    """One increment for two, at the place of the second."""
    for increment in (first, second):
        if not increment.is_combined:
            at(increment.statement, second.statement)
    few, reads = sorted((first.reads, second.reads), key=len)
    reads |= few
    both = _increment_of_both(first.statement, second.statement)
    return replace(second, statement=both, reads=reads, is_combined=True)


def _increment_of_both(first: AugAssign, second: AugAssign) -> AST:
    """The statement, with the operator of the second."""
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
