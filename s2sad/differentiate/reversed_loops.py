"""reversed_loops: the bounds of a counted loop that is run from its last iteration to its first."""
from __future__ import annotations

from s2sad.analyze.dependence import range_parts
from s2sad.tree import AST, BinOp, Constant, For, Mult, Sub, USub, UnaryOp, add, call, const, copy, sub


def reversed_bounds(loop: For, trips: AST | None) -> list[AST]:
    """The bounds of the loop run backwards; `trips` if it was left early."""
    start, stop, step = range_parts(loop)
    first, end = constant_integer(start), constant_integer(stop)
    if trips is None and isinstance(step, int) and step and first is not None and end is not None:
        back = range(first, end, step)[::-1]
        return [const(back.start), const(back.stop), const(back.step)][:2 if back.step == 1 else 3]
    if trips is None and step == 1:
        return [sub_one(stop), sub_one(start), const(-1)]
    if trips is None and step == -1:
        return [add(copy(stop), const(1)), add(copy(start), const(1))]
    if trips is not None and step == 1:
        return [sub_one(add(copy(start), trips)), sub_one(start), const(-1)]
    if trips is not None and step == -1:
        return [add(sub(copy(start), trips), const(1)), add(copy(start), const(1))]
    size = const(step) if isinstance(step, int) else copy(step)
    trips = trips or call("builtins.len", copy(loop.iter))
    last = add(copy(start), BinOp(BinOp(trips, Sub(), const(1)), Mult(), size))
    return [last, BinOp(copy(start), Sub(), size), const(-step) if isinstance(step, int) else BinOp(
        const(0), Sub(), size)]


def constant_integer(node: AST) -> int | None:
    """The integer constant of a bound, if it is one."""
    if isinstance(node, UnaryOp) and isinstance(node.op, USub) and isinstance(node.operand, Constant):
        return -node.operand.value
    return node.value if isinstance(node, Constant) and type(node.value) is int else None


def sub_one(node: AST) -> AST:
    return const(node.value - 1) if isinstance(node, Constant) else BinOp(copy(node), Sub(), const(1))
