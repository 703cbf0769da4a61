"""Sequences by their positions: the range that a loop counts through, and the item at a count.

    enumerate(x, 1)      range(len(x)), item (k + 1, x[k])
    zip(u, v)            range(min(len(u), len(v))), item (u[k], v[k])
    reversed(range(n))   range(n - 1, -1, -1), item k
    h[1:] of a list      range(len(h) - 1), item h[k + 1]
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.sequences.endless import ENDLESS
from s2sad.evaluate.specialize.values import Data, Iteration, MethodValue, TupleValue, Value
from s2sad.liveness import base_name, targets
from s2sad.tree import AST

Item = Callable[[AST], Value]           # of the count


@dataclass(frozen=True)
class CountedSequence:
    """`bounds` are the arguments of the range."""
    bounds: tuple[AST, ...]
    item: Item


def counted_sequence(ev: Evaluator, value: Value, node: AST) -> CountedSequence:
    """What a loop that stays goes through; raises Unevaluated for what is no array, and not made of arrays."""
    if isinstance(value, Iteration) and value.kind == "range":
        return CountedSequence(tuple(ev.spelled(p, node) for p in value.parts), _number)
    if isinstance(value, Iteration) and value.kind == "reversed":
        return _reversed(ev, value.parts[0], node)
    length, item = _ending(ev, value, node)
    return CountedSequence((length,), item)


def _ending(ev: Evaluator, value: Value, node: AST) -> tuple[AST, Item]:
    length, item = _column(ev, value, node)
    if length is None:
        raise ev.unknown(node, "several iterators at once of which none ends",
                         help="go through one of them, and count in the loop: k += 1")
    return length, item


def _number(k: AST) -> Data:
    return Data(k, shape=())


def _column(ev: Evaluator, value: Value, node: AST) -> tuple[AST | None, Item]:
    """Length and item of one sequence, counted from 0; None of one that never ends."""
    if isinstance(value, Iteration) and value.kind in ENDLESS:
        return None, lambda k: ev.item_at(value, _number(k), node, ev.entry)
    if isinstance(value, MethodValue) and value.name == "flat":
        flat = ev.spelled(value, node)
        return tree.attribute(ev.spelled(value.base, node), "size"), lambda k: _number(
            tree.at(tree.index(tree.copy(flat), k), node))
    if isinstance(value, Data):
        return _array(ev, value, node)
    if isinstance(value, Iteration) and value.kind == "range":
        return _range([ev.spelled(p, node) for p in value.parts])
    if isinstance(value, Iteration) and value.kind == "enumerate":
        length, inner = _column(ev, value.parts[0], node)
        start = _start(ev, value.parts[1:], node)
        return length, lambda k: TupleValue((_number(_plus(tree.copy(k), tree.copy(start))), inner(k)))
    if isinstance(value, Iteration) and value.kind == "zip" and value.parts:
        columns = [_column(ev, p, node) for p in value.parts]
        return _least([c[0] for c in columns if c[0] is not None]), lambda k: TupleValue(tuple(
            c[1](tree.copy(k)) for c in columns))
    if isinstance(value, Iteration) and value.kind == "reversed":
        length, inner = _ending(ev, value.parts[0], node)
        return length, lambda k: inner(tree.sub(tree.sub(tree.copy(length), tree.const(1)), k))
    if isinstance(value, Iteration) and value.kind == "part":
        length, place = _column(ev, value.parts[1], node)
        return length, lambda k: ev.item_of(value.parts[0], place(k), node, ev.entry)
    raise ev.unknown(node, "how many items there are must be known before the run", value)


def list_parts(value: Value) -> Value:
    """What a loop goes through, with parts of residual lists as the places of their items."""
    if isinstance(value, Iteration) and value.kind in ("zip", "enumerate", "reversed"):
        return replace(value, parts=tuple(map(list_parts, value.parts)))
    if not isinstance(value, Data) or (found := part_range(value)) is None:
        return value
    listed, bounds = found
    backwards = tree.dump(bounds) == tree.dump(_all_backwards(listed.node))
    span = Iteration("range", tuple(Data(tree.at(n, value.node), shape=()) for n in (
        [tree.call("len", listed.node)] if backwards else bounds)))
    return Iteration("part", (listed, Iteration("reversed", (span,)) if backwards else span))


def part_range(value: Data) -> tuple[Data, list[AST]] | None:
    """The list that a value is a part of, and the bounds of the range of its items' places; None of what is no part of
    a list, or has a step that is not known."""
    node = value.node if value.is_list else None
    if not isinstance(node, tree.Subscript) or not isinstance(node.slice, tree.Slice):
        return None
    listed, step = replace(value, node=node.value), _integer(node.slice.step or tree.const(1))
    if not step:
        return None
    first, last = _all_backwards(node.value)[:2] if step < 0 else (tree.const(0), tree.call("len", node.value))
    start = _place(node.slice.lower, node.value, first, step < 0)
    stop = _place(node.slice.upper, node.value, last, step < 0)
    return listed, [start, stop, *([] if step == 1 else [tree.const(step)])]


def _all_backwards(listed: AST) -> list[AST]:
    return [tree.sub(tree.call("len", tree.copy(listed)), tree.const(1)), tree.const(-1), tree.const(-1)]


def _place(bound: AST | None, listed: AST, missing: AST, backwards: bool) -> AST:
    """A bound of a slice of a list as a place from the start."""
    if bound is None:
        return tree.copy(missing)
    known, length = _integer(bound), tree.call("len", tree.copy(listed))
    if known == 0 and not backwards:
        return bound
    behind = tree.call("max", tree.add(tree.copy(length), bound) if known is None else _minus(
        tree.copy(length), tree.const(-known)), tree.const(-1 if backwards else 0))
    before = tree.call("min", tree.copy(bound), _minus(length, tree.const(int(backwards))))
    return tree.IfExp(tree.compare(tree.copy(bound), tree.Lt(), tree.const(0)), behind, before) if known is None else (
        behind if known < 0 else before)


class PartChanges(Exception):
    """A loop goes through a part of a residual list, which it changes: Python goes through a copy."""


def refuse_changes(ev: Evaluator, value: Value, body: Sequence[AST], node: AST) -> None:
    """Refuses a loop that appends to a residual list that it goes through: Python goes on through what is appended.
    Raises PartChanges where it changes one of which it goes through a part."""
    is_part = isinstance(value, Iteration) and value.kind == "part"
    for part in value.parts[is_part:] if isinstance(value, Iteration) else ():
        refuse_changes(ev, part, body, node)
    listed = value.parts[0] if isinstance(value, Iteration) and is_part else value
    if isinstance(listed, Data) and listed.is_list:
        for n in tree.walk(list(body)):
            if is_part and (_appends(n, listed.name) or listed.name in map(base_name, targets(n))):
                raise PartChanges
            if _appends(n, listed.name):
                raise ev.refusal(node, "a list that grows while it is gone through",
                                 help="write a while loop: while k < len(us)")


def _appends(node: AST, listed: str) -> bool:
    function = node.func if isinstance(node, tree.Call) else None
    return isinstance(function, tree.Attribute) and function.attr in ("append", "pop", "clear") and isinstance(
        function.value, tree.Name) and function.value.id == listed


def _start(ev: Evaluator, given: Sequence[Value], node: AST) -> AST:
    """What an enumeration begins with, which Python wants to be an integer."""
    if given and isinstance(given[0], Data) and given[0].is_known and not isinstance(given[0].known, int):
        raise ev.refusal(given[0].node, "an enumeration from what is no integer")
    return ev.spelled(given[0], node) if given else tree.const(0)


def _array(ev: Evaluator, value: Data, node: AST) -> tuple[AST, Item]:
    def item(k: AST) -> Value:
        found = Data(tree.at(tree.index(ev.spelled(value, node), k), node), demands=value.demands,
                     shape=value.shape[1:] if value.shape else None, origins=value.origins)
        return ev.listed_record(value, found, node)
    return tree.call("len", ev.spelled(value, node)), item


def _range(bounds: Sequence[AST]) -> tuple[AST, Item]:
    start = bounds[0] if len(bounds) > 1 else tree.const(0)
    if len(bounds) < 3:
        return _minus(bounds[-1], start), lambda k: _number(_plus(k, tree.copy(start)))
    length = tree.call("len", tree.call("range", *bounds))
    return length, lambda k: _number(tree.add(tree.copy(start), tree.mult(k, tree.copy(bounds[2]))))


def _reversed(ev: Evaluator, value: Value, node: AST) -> CountedSequence:
    if not isinstance(value, Iteration) or value.kind != "range":
        length, item = _ending(ev, value, node)
        return CountedSequence((_minus(length, tree.const(1)), tree.const(-1), tree.const(-1)), item)
    bounds = [ev.spelled(p, node) for p in value.parts]
    start, stop = (tree.const(0), bounds[0]) if len(bounds) == 1 else bounds[:2]
    step = bounds[2] if len(bounds) == 3 else tree.const(1)
    stride = _integer(step)
    if stride in (1, -1):
        first = _minus(stop, tree.const(stride))
        return CountedSequence((first, _minus(tree.copy(start), tree.const(stride)), tree.const(-stride)), _number)
    rounds = tree.call("len", tree.call("range", start, stop, step))
    last = _plus(tree.mult(tree.sub(rounds, tree.const(1)), tree.copy(step)), tree.copy(start))
    back = tree.const(-stride) if stride is not None else tree.negate(tree.copy(step))
    return CountedSequence((last, tree.sub(tree.copy(start), tree.copy(step)), back), _number)


# -- arithmetic on bounds, as a person would write it -----------------------------------------------------------------

def _integer(node: AST) -> int | None:
    if isinstance(node, tree.UnaryOp) and isinstance(node.op, tree.USub):
        inner = _integer(node.operand)
        return None if inner is None else -inner
    return node.value if isinstance(node, tree.Constant) and type(node.value) is int else None


def _plus(a: AST, b: AST) -> AST:
    left, right = _integer(a), _integer(b)
    if left is not None and right is not None:
        return tree.const(left + right)
    return a if right == 0 else b if left == 0 else tree.add(a, b)


def _minus(a: AST, b: AST) -> AST:
    left, right = _integer(a), _integer(b)
    if left is not None and right is not None:
        return tree.const(left - right)
    if right is not None and right < 0:
        return tree.add(a, tree.const(-right))
    return a if right == 0 else tree.sub(a, b)


def _least(lengths: Sequence[AST]) -> AST | None:
    distinct = list({tree.dump(n): n for n in lengths}.values())
    return None if not distinct else distinct[0] if len(distinct) == 1 else tree.call("min", *distinct)
