"""Iterators that never end: beside others each is known by its item at a count.

    for v, w in zip(x, itertools.cycle((a, b))):            for k in range(len(x)):
        s += v * w                                  ->          s += x[k] * (a, b)[k % 2]

A loop through one alone goes through the generator function that says what it gives (`library/iterators.py`).
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.values import NONE, Data, Iteration, SliceValue, TupleValue, Value, constant
from s2sad.tree import AST

ENDLESS = ("itertools.count", "itertools.cycle", "itertools.repeat")
GENERATED = (*ENDLESS, "itertools.pairwise")
TAKEN = ".taken"


def is_endless(value: Value) -> bool:
    """Whether what is gone through never ends."""
    if not isinstance(value, Iteration) or value.kind in ENDLESS:
        return isinstance(value, Iteration)
    inner = value.parts[1:] if value.kind in ("map", "filter") else value.parts[:1] if (
        value.kind == "enumerate") else value.parts
    return value.kind in ("zip", "map", "enumerate", "filter") and bool(inner) and all(map(is_endless, inner))


@operation
def endless_iterator(ev: Evaluator, kind: str, node: AST, *given: Value) -> Iteration:
    """An iterator, and how many of its items were taken by `next`."""
    made = ev.iterator(kind, *(ev.atoms(g, "given", node) for g in given), constant(0))
    assert made.once is not None
    ev.heap.put(made.once, TAKEN, constant(0))
    return made


@operation
def item_at(ev: Evaluator, value: Iteration, k: Value, node: AST, f: Frame) -> Value:
    """The item behind k others; raises Unevaluated where it cannot be told."""
    assert value.once is not None
    first, second, behind = value.parts[0], value.parts[-2], value.parts[-1]
    if value.kind == "itertools.repeat":
        return first
    place = _sum(ev, _sum(ev, k, ev.heap[value.once].items[TAKEN], node, f), behind, node, f)
    if value.kind == "itertools.cycle":
        assert isinstance(first, TupleValue)
        ev.refuse_changed(first, second, node)
        return ev.item_of(first, ev.binary(tree.Mod(), place, constant(len(first.items)), node, f), node, f)
    start, step = (ev.known(v, node, "where a count beside other sequences starts, and its step,") for v in (
        first, second))
    if type(start) is int and type(step) is int:
        steps = place if step == 1 else ev.binary(tree.Mult(), constant(step), place, node, f)
        return _sum(ev, constant(start), steps, node, f)
    total = start
    for _ in range(ev.known(place, node, "how often a float was added")):
        total += step
    return constant(total)


def _sum(ev: Evaluator, a: Value, b: Value, node: AST, f: Frame) -> Value:
    zero = [isinstance(v, Data) and v.is_known and v.known == 0 for v in (a, b)]
    return b if zero[0] else a if zero[1] else ev.binary(tree.Add(), a, b, node, f)


def behind_first(value: Iteration) -> Iteration:
    """The same without its first item."""
    *given, behind = value.parts
    assert isinstance(behind, Data)
    return replace(value, parts=(*given, constant(behind.known + 1)))


def _rank(ev: Evaluator, value: Value, node: AST, f: Frame) -> int:
    """How many axes an array has, whose items are views from two on; 0 where it is not known, or of anything else."""
    if not isinstance(value, Data) or value.is_list or value.is_known:
        return 0
    if value.shape is not None:
        return len(value.shape)
    rank = ev.attribute_of(value, "ndim", node, f)
    if isinstance(rank, Data) and rank.demands and not rank.is_known:
        raise ev.unknown(node, "how many axes an array has must be known before the run", rank)
    return rank.known if isinstance(rank, Data) and type(rank.known) is int else 0


@dataclass(frozen=True)
class OfEndless:
    """The items of an iterator that never ends."""
    ev: Evaluator
    base: Iteration
    node: AST
    f: Frame
    k: int = 0

    def next(self) -> tuple[Value, Any]:
        item = item_at(self.ev, self.base, constant(self.k), self.node, self.f)
        return item, OfEndless(self.ev, self.base, self.node, self.f, self.k + 1)


@operation
def as_generator(ev: Evaluator, value: Value, node: AST, f: Frame) -> Value:
    """What a loop goes through, as the generator that says what it gives where there is one."""
    if isinstance(value, Iteration) and value.kind == "enumerate":
        return replace(value, parts=(as_generator(ev, value.parts[0], node, f), *value.parts[1:]))
    if isinstance(value, Iteration) and value.kind in ("map", "filter", "generator"):
        return ev.in_statements(value, node, f)
    if not isinstance(value, Iteration) or value.kind not in GENERATED:
        return value
    ev.used(value, node)
    if value.kind == "itertools.pairwise" and _rank(ev, value.parts[0], node, f) > 1:
        rest = ev.item_of(value.parts[0], SliceValue((constant(1), NONE, NONE)), node, f)
        return ev.iterator("zip", value.parts[0], rest)
    given = value.parts[:1]
    if value.kind in ("itertools.count", "itertools.cycle"):
        given = value.parts[:2] if value.kind == "itertools.count" else value.parts[1:2]
    if value.kind in ENDLESS and value.once is not None:
        taken = ev.heap[value.once].items[TAKEN]
        if not (isinstance(taken, Data) and taken.known == 0):
            raise ev.refusal(node, "a loop through an iterator that never ends, of which next() took items",
                             help="count in the loop: k += 1")
    return ev.written_function(value.kind, given, {}, node, f)
