"""rank_one_update: increments of a matrix by a column times a row, in loops or at once.

    for j in range(m):                              the factors are s[j] and c * x[i, k]
        for k in range(d):
            a_bar[j, k] += s[j] * (c * x[i, k])
    a_bar[...] += np.outer(s, x[i])                 the factors are s and x[i]
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad.liveness import base_name
from s2sad.simplify.algebra import integer_literal
from s2sad.optimize.loop_bounds import counted_loop, counter_offset
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Constant, For, Mult, Sub, Subscript, at, attribute, augment, call, call_name,
    const, copy, counted_for, dump, index, indices, is_comment, mult, name, names,
)


@dataclass(frozen=True)
class RankOneUpdate:
    """A rank-one update: the statement with all its loops and the increment in them, counters and stops of the loops,
    if there are any, and the factors."""
    nest: AST
    increment: AugAssign
    counters: tuple[str, ...]
    ends: tuple[AST, ...]
    factors: tuple[AST, AST]

    @property
    def array(self) -> str:
        return base_name(self.increment.target)

    def sizes(self) -> list[AST]:
        """The lengths of the column and the row."""
        if not self.ends:
            return [index(attribute(name(self.array), "shape"), const(k)) for k in (0, 1)]
        return [copy(end) if isinstance(end, Subscript) else call("builtins.max", copy(end), const(0))
                for end in self.ends]

    def with_matrix(self, matrix: str) -> AST:
        """The statement that adds a matrix instead."""
        value = index(name(matrix), *map(name, self.counters)) if self.counters else name(matrix)
        inner = at(augment(copy(self.increment.target), self.increment.op, value), self.increment)
        for counter, end in reversed(list(zip(self.counters, self.ends))):
            inner = at(counted_for(counter, [copy(end)], [inner]), self.increment)
        return inner


def rank_one_update(statement: AST) -> RankOneUpdate | None:
    """The rank-one update that a statement is, None if it is none."""
    if isinstance(statement, AugAssign):
        return _outer_product(statement)
    outer = _from_zero(statement)
    rest = _without_comments(statement.body) if outer is not None and isinstance(statement, For) else []
    inner = _from_zero(rest[0]) if len(rest) == 1 else None
    if outer is None or inner is None:
        return None
    body = _without_comments(rest[0].body)
    increment = body[0] if len(body) == 1 else None
    if not isinstance(increment, AugAssign) or not isinstance(increment.op, (Add, Sub)) or not isinstance(
            increment.target, Subscript) or len(indices(increment.target)) != 2 or outer[0] in names(inner[1]):
        return None
    factors = _column_and_row(increment.value, outer[0], inner[0])
    if factors is None or base_name(increment.target) in names(increment.value):
        return None
    return RankOneUpdate(statement, increment, (outer[0], inner[0]), (outer[1], inner[1]), factors)


def _outer_product(increment: AugAssign) -> RankOneUpdate | None:
    """The update `a_bar[...] += np.outer(s, r)`."""
    if not isinstance(increment.op, (Add, Sub)) or not isinstance(increment.target, Subscript) or call_name(
            increment.value) != "numpy.outer" or base_name(increment.target) in names(increment.value):
        return None
    whole = isinstance(increment.target.slice, Constant) and increment.target.slice.value is Ellipsis
    column, row = increment.value.args[:2]
    return RankOneUpdate(increment, increment, (), (), (column, row)) if whole else None


def _column_and_row(value: AST, first: str, second: str) -> tuple[AST, AST] | None:
    """The factors of a product by the counter that they read; invariant ones belong to the column."""
    column: AST | None = None
    row: AST | None = None
    for factor in _factors(value):
        read = set(names(factor))
        if {first, second} <= read:
            return None
        if second in read:
            row = factor if row is None else mult(row, factor)
        else:
            column = factor if column is None else mult(column, factor)
    return None if row is None or column is None or first not in names(column) else (column, row)


def added_row(statement: AST | None, vector: str, counter: str) -> Subscript | None:
    """The element in row `counter` of a matrix to which a loop adds, or which it stores, a vector's element; None if a
    statement does anything else."""
    outer = None if statement is None else _from_zero(statement)
    body = _without_comments(statement.body) if isinstance(statement, For) else []
    if outer is None or len(body) != 1 or not isinstance(body[0], (Assign, AugAssign)):
        return None
    target = body[0].target if isinstance(body[0], AugAssign) else body[0].targets[0]
    value = body[0].value
    if isinstance(body[0], AugAssign) and not isinstance(body[0].op, (Add, Sub)) or not isinstance(target, Subscript):
        return None
    row, *rest = indices(target)
    if not isinstance(value, Subscript) or dump(value) != dump(index(name(vector), name(outer[0]))):
        return None
    is_row = counter_offset(row, counter) == 0 and len(rest) == 1 and counter_offset(rest[0], outer[0]) is not None
    return target if is_row else None


def _from_zero(statement: AST) -> tuple[str, AST] | None:
    """The counter and the end of a loop from 0 upwards."""
    bounds = counted_loop(statement)
    if bounds is None or bounds.step != 1 or integer_literal(bounds.start) != 0:
        return None
    return bounds.counter, bounds.stop


def _without_comments(block: list[AST]) -> list[AST]:
    return [s for s in block if not is_comment(s)]


def _factors(node: AST) -> list[AST]:
    if isinstance(node, BinOp) and isinstance(node.op, Mult):
        return _factors(node.left) + _factors(node.right)
    return [node]


__all__ = ["RankOneUpdate", "added_row", "rank_one_update"]
