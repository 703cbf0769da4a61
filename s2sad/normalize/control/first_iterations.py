"""first_iterations: whether a loop over a range has an iteration, and whether one is the first.

    for i in range(1, n):       it has one if        1 < n
                                the first is where   i == 1
                                behind it are        i > 1, i != 1, i == 3, i >= 2, not i == 1
"""
from __future__ import annotations

from collections.abc import Sequence

from s2sad.tree import (
    AST, And, Attribute, BinOp, BoolOp, Compare, Constant, Eq, For, Gt, GtE, Lt, LtE, Name, Not, NotEq, Subscript,
    UnaryOp, USub, call_name, compare, const, copy, equal, name, names, stored_names, walk,
)

_NEGATED = {Eq: NotEq, NotEq: Eq, Gt: LtE, LtE: Gt, Lt: GtE, GtE: Lt}
_TURNED = {Eq: Eq, NotEq: NotEq, Gt: Lt, Lt: Gt, GtE: LtE, LtE: GtE}
_BEHIND = {  # by the operator of a test of a counter that goes up against a constant: whether the start does not pass
    Eq: lambda start, c: start != c, NotEq: lambda start, c: start == c, Gt: lambda start, c: start <= c,
    GtE: lambda start, c: start < c, Lt: lambda start, c: False, LtE: lambda start, c: False}


def bounds(loop: For) -> tuple[AST, AST, int] | None:
    """Where a loop over a range starts and stops, and its step; None of one whose step is not written."""
    if call_name(loop.iter) != "builtins.range" or loop.iter.keywords:
        return None
    given = loop.iter.args
    step = _constant(given[2]) if len(given) == 3 else 1
    if step is None or step == 0:
        return None
    return (const(0), given[0], step) if len(given) == 1 else (given[0], given[1], step)


def runs(loop: For) -> bool | AST | None:
    """Whether a loop has an iteration: a constant, or a test for before it; None if it has no such test."""
    found = bounds(loop)
    if found is None:
        return None
    start, stop, step = found
    known = _constant(start), _constant(stop)
    if known[0] is not None and known[1] is not None:
        return known[0] < known[1] if step > 0 else known[0] > known[1]
    return compare(copy(start), Lt() if step > 0 else Gt(), copy(stop))


def first_iteration(loop: For) -> AST | None:
    """The test whether an iteration is a loop's first; None if the body changes what it would ask."""
    found = bounds(loop)
    if found is None or not isinstance(loop.target, Name):
        return None
    start, stored = found[0], {*stored_names(loop.body)}
    if not all(map(_is_of_names, walk(start))) or stored & {loop.target.id, *names(start)}:
        return None
    return compare(name(loop.target.id), Eq(), copy(start))


def _is_of_names(node: AST) -> bool:
    """Whether a part of an expression is the same as long as names are: nothing that memory holds."""
    if isinstance(node, Subscript):
        return isinstance(node.value, Attribute)
    return isinstance(node, (Name, Constant, BinOp, UnaryOp)) or not node._fields or (
        isinstance(node, Attribute) and node.attr in ("shape", "size"))


def is_behind_first(loop: For, facts: Sequence[AST]) -> bool:
    """Whether tests that hold in an iteration say that it is not the first of a loop that has `first_iteration`."""
    return any(_is_behind(loop, fact, True) for fact in facts)


def _is_behind(loop: For, fact: AST, holds: bool) -> bool:
    found = bounds(loop)
    assert found is not None
    start, _, step = found
    if isinstance(fact, UnaryOp) and isinstance(fact.op, Not):
        return _is_behind(loop, fact.operand, not holds)
    if isinstance(fact, BoolOp):
        each = [_is_behind(loop, v, holds) for v in fact.values]
        return any(each) if isinstance(fact.op, And) is holds else all(each)
    if isinstance(fact, Name):
        return fact.id == loop.target.id and (_constant(start) == 0) is holds and _constant(start) is not None
    if not isinstance(fact, Compare) or len(fact.ops) > 1 or type(fact.ops[0]) not in _NEGATED:
        return False
    left, op, right = fact.left, type(fact.ops[0]), fact.comparators[0]
    if isinstance(right, Name) and right.id == loop.target.id:
        left, op, right = right, _TURNED[op], left
    if not isinstance(left, Name) or left.id != loop.target.id:
        return False
    op = op if holds else _NEGATED[op]
    if equal(right, start):
        return op in (NotEq, Gt if step > 0 else Lt)
    constants = _constant(start), _constant(right)
    return step > 0 and None not in constants and _BEHIND[op](*constants)


def _constant(node: AST) -> int | None:
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = _constant(node.operand)
        return None if inner is None else -inner
    known = isinstance(node, Constant) and type(node.value) is int
    return node.value if known else None
