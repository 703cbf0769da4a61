"""range_values: a range that has a name, or of which a part is taken, is one that is written where a loop goes
through it.

    steps = range(n)                for i in range(n):
    for i in steps:
    dt = x.dtype                    w = np.zeros(n, dtype=x.dtype)
    w = np.zeros(n, dtype=dt)
    for i in range(n)[1:-1]:        for i in range(1, n - 1):
    for i in range(a, b)[::2]:      for i in range(a, b, 2):
    for i in range(n)[::-1]:        for i in reversed(range(n)):

A name stands for its range, or for a dtype, where it is bound once and what that is made of does not change. Parts
that depend on how long the range is stay, to be refused.
"""
from __future__ import annotations

from s2sad.tree import (
    AST, Assign, Attribute, BinOp, Call, Constant, For, FunctionDef, Load, Name, Slice, Store, Subscript, USub, UnaryOp,
    While, add, at, children, const, copy, expr, name, rebuild, walk, walk_statements, written,
)


def unnamed(function: FunctionDef) -> FunctionDef:
    """The function without names of ranges and dtypes."""
    stored = [n.id for n in walk(function) if isinstance(n, Name) and not isinstance(n.ctx, Load)]
    in_loops = {n.id for s in walk_statements(function.body) if isinstance(s, (For, While)) for n in walk(s)
                if isinstance(n, Name) and isinstance(n.ctx, Store)}
    found = {s.targets[0].id: s.value for s in function.body if isinstance(s, Assign) and len(s.targets) == 1
             and isinstance(s.targets[0], Name) and (_is_range(s.value) or _is_dtype(s.value))}
    kept = {n: r for n, r in found.items() if stored.count(n) == 1 and all(
        stored.count(m.id) <= 1 and m.id not in in_loops for m in walk(r) if isinstance(m, Name))}
    if not kept:
        return function

    def change(n: AST) -> AST | None:
        named = isinstance(n, Name) and n.id in kept and isinstance(n.ctx, Load)
        return at(copy(kept[n.id]), n) if named else None  # pyright: ignore[reportAttributeAccessIssue]
    function.body = [rebuild(s, change) for s in function.body if not (
        isinstance(s, Assign) and isinstance(s.targets[0], Name) and s.targets[0].id in kept)] or function.body
    return function


def ranged(iterable: AST) -> AST:
    """What a loop goes through; a part of a range as a range."""
    if not isinstance(iterable, Subscript) or not isinstance(iterable.slice, Slice) or not _is_range(iterable.value):
        return iterable
    part, called = iterable.slice, iterable.value
    lower, upper, step = (0 if b is None else _number(b) for b in (part.lower, part.upper, part.step))
    given = len(called.args)
    if (lower, upper, step) == (0, 0, -1) and part.upper is None:
        return at(Call(at(name("reversed"), iterable), [called], []), iterable)
    if lower is None or upper is None or step is None or lower < 0 or step < 0 or given > 2 or (
            part.upper is not None and upper >= 0):
        return iterable
    start, stop = called.args if given == 2 else (const(0), called.args[0])
    first, end = _moved(start, lower), _moved(stop, upper)
    steps = [const(step)] if step else []
    return at(Call(called.func, [first, end, *steps], []), iterable)


def _moved(bound: AST, by: int) -> AST:
    if isinstance(bound, Constant) and type(bound.value) is int:
        return const(bound.value + by)
    return bound if by == 0 else add(bound, const(by))


def _number(node: AST) -> int | None:
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = _number(node.operand)
        return None if inner is None else -inner
    return node.value if isinstance(node, Constant) and type(node.value) is int else None


def _is_range(node: AST) -> bool:
    """Whether an expression is a range of what may be computed again."""
    return isinstance(node, Call) and isinstance(node.func, Name) and node.func.id == "range" and not node.keywords \
        and all(map(_is_settled, node.args))


def _is_dtype(node: AST) -> bool:
    """Whether an expression is the dtype of what has a name."""
    return isinstance(node, Attribute) and node.attr == "dtype" and isinstance(node.value, Name)


def _is_settled(node: AST) -> bool:
    """Whether an expression is made of names, numbers and the sizes of what has a name."""
    if isinstance(node, Subscript):
        return isinstance(node.value, Attribute) and _is_settled(node.value) and _is_settled(node.slice)
    if isinstance(node, Attribute):
        return node.attr in ("shape", "size") and isinstance(node.value, Name)
    if isinstance(node, Call):
        return written(node.func) == "len" and len(node.args) == 1 and isinstance(node.args[0], Name)
    return not isinstance(node, expr) or isinstance(node, (Constant, Name, BinOp, UnaryOp)) and all(
        map(_is_settled, children(node)))
