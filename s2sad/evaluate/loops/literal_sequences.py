"""Sequences whose items are spelled out in the text, also through slices, reversed, zip and enumerate."""
from __future__ import annotations

from s2sad.tree import (
    AST, Call, Constant, List, Slice, Starred, Subscript, Tuple, UnaryOp, USub, add, call_name, const, copy, tuple_of,
)


def literal(iterable: AST) -> list[AST] | None:
    """The items that are spelled out, or None if the sequence is not a literal one."""
    if isinstance(iterable, (Tuple, List)):
        return None if any(isinstance(item, Starred) for item in iterable.elts) else list(iterable.elts)
    if isinstance(iterable, Subscript) and isinstance(iterable.slice, Slice):
        items, part = literal(iterable.value), iterable.slice
        bounds = [p if p is None else _number(p) for p in (part.lower, part.upper, part.step)]
        known = all(b is not None or p is None for b, p in zip(bounds, (part.lower, part.upper, part.step)))
        return items[slice(*bounds)] if items is not None and known and bounds[2] != 0 else None
    called, parts = call_name(iterable), getattr(iterable, "args", [])
    if called in ("builtins.reversed", "builtins.list", "builtins.tuple") and len(parts) == 1:
        items = literal(parts[0])
        return items[::-1] if items is not None and called == "builtins.reversed" else items
    if called == "builtins.zip" and parts:
        columns = [literal(p) for p in parts]
        return None if any(c is None for c in columns) else [tuple_of(*map(copy, row)) for row in zip(*columns)]
    if called == "builtins.enumerate" and parts:
        items, start = literal(parts[0]), _start(iterable)
        return None if items is None else [tuple_of(_plus(const(k), start), item) for k, item in enumerate(items)]
    return None


def _start(node: Call) -> AST:
    given = [*node.args[1:], *(k.value for k in node.keywords if k.arg == "start")]
    return given[0] if given else const(0)


def _number(node: AST) -> int | None:
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = _number(node.operand)
        return None if inner is None else -inner
    whole = isinstance(node, Constant) and isinstance(node.value, int) and not isinstance(node.value, bool)
    return node.value if whole else None


def _plus(a: AST, b: AST) -> AST:
    left, right = _number(a), _number(b)
    if left is not None and right is not None:
        return const(left + right)
    return a if right == 0 else b if left == 0 else add(a, b)


