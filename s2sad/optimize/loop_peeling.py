"""loop_peeling: the first or last iteration runs by itself, so that the others need no test of the counter.

    for i in range(n - 1, -1, -1):          for i in range(n - 1, max(n - 2, -1), -1):
        right = u[i + 1] if i < n - 1 else first        right = u[i + 1] if i < n - 1 else first
                                            for i in range(n - 2, -1, -1):
                                                right = u[i + 1]

*Requires* an innermost counted loop. *Establishes* the same iterations in the same order; each part is a loop, since
there may be nothing to peel.
"""
from __future__ import annotations

from s2sad.simplify.algebra import add_constant, simplify_index
from s2sad.optimize.loop_bounds import CountedLoop, affine, bound_names, substitute_symbol, range_arguments
from s2sad.tree import (
    AST, Assign, Compare, Constant, Eq, For, Gt, GtE, If, IfExp, Lt, LtE, Name, Not, NotEq, Store, UnaryOp, at, call,
    const, copy, counted_for, dump, names, rebuild, walk,
)

CHANGES_ROUNDING = False

_PEELED_SIDES = ((0, 0), (1, 0), (0, 1), (1, 1))


def loop_peeling(loop: For, bounds: CountedLoop) -> tuple[list[AST], For, list[AST]] | None:
    """The peeled first iterations, the loop without tests of its counter, the peeled last ones; None if peeling decides
    no test."""
    tests = {dump(n): n for n in walk(loop.body) if isinstance(n, Compare)}
    bound = bound_names(loop.body)
    known = {sides: {d: v for d, t in tests.items() if (v := _constant_outcome(t, bounds, bound, *sides)) is not None}
             for sides in _PEELED_SIDES}
    first, last = max(_PEELED_SIDES, key=lambda sides: (len(known[sides]), -sum(sides)))
    if not known[first, last]:
        return None
    body = _fold_tests(loop.body, known[first, last])
    start, stop, step = bounds.start, bounds.stop, bounds.step
    second = simplify_index(add_constant(copy(start), step), integers=True)
    before_last = simplify_index(add_constant(copy(stop), -step), integers=True)
    nearer, further = ("builtins.min", "builtins.max") if step > 0 else ("builtins.max", "builtins.min")
    by = [] if step > 0 else [const(-1)]
    heads = [start, call(nearer, second, copy(stop))]
    begin = second if first else start
    tails = [call(further, copy(begin), copy(before_last)), stop]
    before: list[AST] = [_loop(loop, [*heads, *by], loop.body)] if first else []
    after: list[AST] = [_loop(loop, [*tails, *by], loop.body)] if last else []
    return before, _loop(loop, [begin, before_last if last else stop, *by], body), after


def _loop(loop: For, bounds: list[AST], body: list[AST]) -> For:
    return at(counted_for(loop.target.id, range_arguments(list(map(copy, bounds))), copy(body)), loop)


def _constant_outcome(test: Compare, bounds: CountedLoop, bound: set[str], first: int, last: int) -> bool | None:
    """The outcome of a comparison in all iterations but the first and the last ones, None if it is not constant."""
    ends = bounds.ends(first, last)
    if ends is None or len(test.ops) != 1 or bounds.counter not in names(test) or bound & set(names(test)):
        return None
    left, right = affine(test.left), affine(test.comparators[0])
    if left is None or right is None:
        return None
    form = left.plus(right, -1)
    low, high = ends if dict(form.terms).get(bounds.counter, 0) > 0 else ends[::-1]
    least, most = substitute_symbol(form, bounds.counter, low), substitute_symbol(form, bounds.counter, high)
    return _sign_outcome(test.ops[0], None if least.terms else least.constant, None if most.terms else most.constant)


def _sign_outcome(op: AST, least: int | None, most: int | None) -> bool | None:
    """The outcome of `form op 0` for a form between two numbers, None for an unknown one."""
    negative, positive = most is not None and most < 0, least is not None and least > 0
    if isinstance(op, (Eq, NotEq)):
        return isinstance(op, NotEq) if negative or positive else None
    if isinstance(op, (Gt, LtE)):
        return isinstance(op, Gt) if positive else isinstance(op, LtE) if most is not None and most <= 0 else None
    if isinstance(op, (Lt, GtE)):
        return isinstance(op, Lt) if negative else isinstance(op, GtE) if least is not None and least >= 0 else None
    return None


def _fold_tests(body: list[AST], known: dict[str, bool]) -> list[AST]:
    """The body with known tests folded, also through a name that is bound to one, once."""
    stored = [n.id for n in walk(body) if isinstance(n, Name) and type(n.ctx) is Store]
    flags = {s.targets[0].id: known[dump(s.value)] for s in body if isinstance(s, Assign)
             and isinstance(s.targets[0], Name) and stored.count(s.targets[0].id) == 1 and dump(s.value) in known
             and s.targets[0].id not in names(body[:body.index(s)])}
    return _fold_block(body, known, flags)


def _fold_block(block: list[AST], known: dict[str, bool], flags: dict[str, bool]) -> list[AST]:
    def value(test: AST) -> bool | None:
        if isinstance(test, UnaryOp) and isinstance(test.op, Not):
            inner = value(test.operand)
            return None if inner is None else not inner
        return flags.get(test.id) if isinstance(test, Name) else known.get(dump(test))

    def change(node: AST) -> AST | None:
        if isinstance(node, IfExp) and (taken := value(node.test)) is not None:
            return rebuild(node.body if taken else node.orelse, change)
        if isinstance(node, Compare) and dump(node) in known:
            return Constant(known[dump(node)], None)
        return None

    made: list[AST] = []
    for statement in block:
        taken = value(statement.test) if isinstance(statement, If) else None
        if taken is not None:
            made += _fold_block(statement.body if taken else statement.orelse, known, flags)
        elif isinstance(statement, If):
            made.append(at(If(rebuild(statement.test, change), _fold_block(statement.body, known, flags),
                              _fold_block(statement.orelse, known, flags)), statement))
        else:
            made.append(rebuild(statement, change))
    return made
