"""guard_motion: what a loop asks of the number of items in each iteration is asked once, before it.

    def f(x: "float64[:, :]", n: int):      def f(x, n):
        s = 0.0                                 s = 0.0
        for i in range(n):                      assert n <= 0 or x.shape[1] == 2
            a, b = x[i]                         for i in range(n):
            s += a * b                              a = x[i, 0]
        return s                                    b = x[i, 1]
                                                    s += a * b
                                                return s

Requires resolved views, in which the number is a size. Establishes that no loop over a range has such a guard of what
it does not bind, but in its branches: the forward sweep of an adjoint would keep the loop for its sake.
"""
from __future__ import annotations

from s2sad.blocks import with_blocks
from s2sad.evaluate.unpacking import ITEMS
from s2sad.infer.signatures.laws import whole_number
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Assert, BoolOp, Break, Constant, Continue, For, FunctionDef, GtE, LtE, Or, Return, at, compare, const, copy,
    dump, names, stored_names, walk_statements, with_body,
)


def guard_motion(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with these guards before its loops."""
    if not any(map(_counts_items, walk_statements(function.body))):
        return function
    return with_body(function, _block(function.body))


def _block(statements: list[AST]) -> list[AST]:
    new: list[AST] = []
    for statement in statements:
        made = with_blocks(statement, _block)
        moved = _movable(made) if isinstance(made, For) else []
        new += list({dump(s): s for s in moved}.values())
        gone = {id(s) for s, _ in _guards(made)} if moved else set()
        new.append(with_blocks(made, lambda body, gone=gone: [s for s in body if id(s) not in gone]) if moved else made)
    return new


def _counts_items(statement: AST) -> bool:
    return isinstance(statement, Assert) and isinstance(statement.msg, Constant) and statement.msg.value == ITEMS


def _guards(loop: AST) -> list[tuple[AST, AST]]:
    """The guards that each iteration comes to, and that do not depend on it, each with its test."""
    bound, found = {*stored_names(loop)}, list[tuple[AST, AST]]()
    for statement in loop.body:
        if any(isinstance(s, (Break, Continue, Return)) for s in walk_statements([statement])):
            break
        if _counts_items(statement) and bound.isdisjoint(names(statement.test)):
            found.append((statement, statement.test))
    return found


def _movable(loop: For) -> list[AST]:
    """The guards as they are before a loop, which may have no iteration."""
    args = loop.iter.args
    start, stop = (const(0), args[0]) if len(args) == 1 else args[:2]
    step = whole_number(args[2]) if len(args) > 2 else 1
    if not step:
        return []
    empty = compare(copy(stop), LtE() if step > 0 else GtE(), copy(start))
    made: list[AST] = []
    for guard, test in _guards(loop):
        either = [copy(t) for t in (test.values if isinstance(test, BoolOp) and isinstance(test.op, Or) else [test])]
        more = [] if dump(empty) in map(dump, either) else [copy(empty)]
        made.append(at(Assert(BoolOp(Or(), [*more, *either]), guard.msg), guard))
    return made


__all__ = ["guard_motion"]
