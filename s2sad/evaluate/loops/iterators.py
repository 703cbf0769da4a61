"""What a `for` goes through, as a length and the item at a position.

    enumerate(x, 1)      length len(x), item (k + 1, x[k])
    zip(u, v)            length min(len(u), len(v)), item (u[k], v[k])
    reversed(range(n))   range(n - 1, -1, -1)
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from s2sad.evaluate.loops.late_reads import is_read_late
from s2sad.evaluate.scope import KernelScope, atomic
from s2sad.tree import (
    AST, Call, Constant, List, Slice, Starred, Subscript, Tuple, UnaryOp, USub, add, call, call_name, const,
    copy, dump, index, mult, negate, sub, tuple_of,
)

_NOT_NESTED = ("numpy.ndindex", "numpy.ndenumerate", "numpy.nditer")
Hold = Callable[[AST, str], AST]        # an expression that keeps its value throughout the loop, with a wanted name


@dataclass(frozen=True)
class Sequence:
    """`bounds` are the arguments of the range to count; `item` gives what the target is bound to at a count."""
    bounds: list[AST]
    item: Callable[[AST], AST]


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


def sequence(iterable: AST, hold: Hold, scope: KernelScope) -> Sequence | None:
    """The sequence of a loop's iterable; None, and a diagnostic, if it is none that is known."""
    called = call_name(iterable)
    if called == "builtins.range":
        bounds = [hold(b, w) for b, w in zip(iterable.args, _roles(iterable))]
        return Sequence(bounds, lambda k: k)
    if called == "builtins.reversed" and len(iterable.args) == 1:
        return _reversed(iterable.args[0], hold, scope)
    found = _column(iterable, hold, scope)
    return None if found is None else Sequence([found[0]], found[1])


def _roles(node: Call) -> list[str]:
    return ["stop"] if len(node.args) == 1 else ["start", "stop", "step"]


def _rows(array: AST) -> tuple[AST, Callable[[AST], AST]]:
    return call("builtins.len", array), lambda k: index(copy(array), k)


def _start(node: Call) -> AST:
    given = [*node.args[1:], *(k.value for k in node.keywords if k.arg == "start")]
    return given[0] if given else const(0)


def _counts_from(node: Call, scope: KernelScope) -> AST:
    """Where an enumeration begins, which Python wants to be an integer."""
    start = _start(node)
    if isinstance(start, Constant) and not isinstance(start.value, int):
        scope.refuse(start, "an enumeration from what is no integer")
    return start


def _column(node: AST, hold: Hold, scope: KernelScope) -> tuple[AST, Callable[[AST], AST]] | None:
    """Length and item of one sequence, counted from 0."""
    called = call_name(node)
    if called == "builtins.range" and node.args:
        return _counted(node, hold)
    if called == "builtins.enumerate" and node.args:
        inner, start = _column(node.args[0], hold, scope), hold(_counts_from(node, scope), "start")
        if inner is None:
            return None
        length, item = inner
        return length, lambda k: tuple_of(_plus(copy(k), copy(start)), item(k))
    if called == "builtins.zip" and node.args and not _strict(node):
        found = [_column(a, hold, scope) for a in node.args]
        columns = [c for c in found if c is not None]
        if len(columns) < len(found):
            return None
        return _least([c[0] for c in columns]), lambda k: tuple_of(*[c[1](copy(k)) for c in columns])
    if called == "builtins.reversed" and len(node.args) == 1:
        inner = _column(node.args[0], hold, scope)
        if inner is None or call_name(node.args[0]) in ("builtins.enumerate", "builtins.zip"):
            scope.refuse(node, "reversed() of this", help="reverse a range or an array")
            return None
        return inner[0], lambda k: inner[1](sub(sub(copy(inner[0]), const(1)), k))
    if isinstance(node, (Tuple, List)) and any(map(_is_number, node.elts)) and not any(map(is_read_late, node.elts)):
        return _rows(hold(call("numpy.array", List(list(node.elts), node.ctx)), "items"))
    if (called or "").startswith("builtins.") or isinstance(node, (Tuple, List, Constant)):
        scope.refuse(node, "this cannot be looped over here", help="loop over a range, an array, enumerate or zip")
        return None
    if called in _NOT_NESTED:
        if called == "numpy.ndenumerate":
            scope.refuse(node, "np.ndenumerate over an unknown number of axes, or of something that has no name",
                         help="name the indices: for (i, j), v in np.ndenumerate(x)")
            return None
        scope.refuse(node, f"{called} inside another iterator", help="write the loops out with range")
        return None
    return _rows(hold(node, "items"))


def _strict(node: Call) -> bool:
    return any(not (isinstance(k.value, Constant) and k.value.value is False) for k in node.keywords)


def _counted(node: Call, hold: Hold) -> tuple[AST, Callable[[AST], AST]]:
    held = [hold(b, w) for b, w in zip(node.args, _roles(node))]
    start = held[0] if len(held) > 1 else const(0)
    if len(held) < 3:
        return _minus(held[-1] if len(held) == 1 else held[1], start), lambda k: _plus(k, copy(start))
    step = held[2] if atomic(held[2]) or _number(held[2]) is not None else hold(held[2], "step")
    return call("builtins.len", call("builtins.range", *held)), lambda k: add(copy(start), mult(k, copy(step)))


def _reversed(node: AST, hold: Hold, scope: KernelScope) -> Sequence | None:
    if call_name(node) == "builtins.range" and node.args:
        held = [hold(b, w) for b, w in zip(node.args, _roles(node))]
        start, stop = (const(0), held[0]) if len(held) == 1 else (held[0], held[1])
        step = held[2] if len(held) == 3 else const(1)
        stride = _number(step)
        if stride is not None and stride in (1, -1):
            unit = const(stride)
            return Sequence([_minus(stop, unit), _minus(copy(start), copy(unit)), const(-stride)], lambda k: k)
        steps = sub(call("builtins.len", call("builtins.range", start, stop, step)), const(1))
        last = _plus(mult(steps, copy(step)), copy(start))
        return Sequence([last, sub(copy(start), copy(step)), negate(copy(step))], lambda k: k)
    if call_name(node) in ("builtins.enumerate", "builtins.zip"):
        scope.refuse(node, "reversed() of this", help="reverse a range or an array")
        return None
    inner = _column(node, hold, scope)
    return None if inner is None else Sequence([_minus(inner[0], const(1)), const(-1), const(-1)], inner[1])


# -- arithmetic on bounds, as a person would write it -----------------------------------------------------------------

def _number(node: AST) -> int | None:
    if isinstance(node, UnaryOp) and isinstance(node.op, USub):
        inner = _number(node.operand)
        return None if inner is None else -inner
    whole = isinstance(node, Constant) and isinstance(node.value, int) and not isinstance(node.value, bool)
    return node.value if whole else None


def _is_number(node: AST) -> bool:
    inner = node.operand if isinstance(node, UnaryOp) and isinstance(node.op, USub) else node
    return isinstance(inner, Constant) and isinstance(inner.value, (int, float)) and not isinstance(inner.value, bool)


def _plus(a: AST, b: AST) -> AST:
    left, right = _number(a), _number(b)
    if left is not None and right is not None:
        return const(left + right)
    return a if right == 0 else b if left == 0 else add(a, b)


def _minus(a: AST, b: AST) -> AST:
    left, right = _number(a), _number(b)
    if left is not None and right is not None:
        return const(left - right)
    if right is not None and right < 0:
        return add(a, const(-right))
    return a if right == 0 else sub(a, b)


def _least(items: list[AST]) -> AST:
    distinct = list({dump(item): item for item in items}.values())
    return distinct[0] if len(distinct) == 1 else call("builtins.min", *distinct)
