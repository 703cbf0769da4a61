"""Loops whose first round differs in structure: it is written out, and the others stay a loop.

    prev = None                                  if len(x) > 0:
    for v in x:                                      prev = x[0]
        if prev is not None:             ->          for v in x[1:]:
            s += (v - prev) ** 2                         s += (v - prev) ** 2
        prev = v                                         prev = v
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.sequences.endless import ENDLESS, behind_first
from s2sad.evaluate.specialize.values import Data, Iteration, TupleValue, Value, constant
from s2sad.program import Fact
from s2sad.tree import AST


@dataclass(frozen=True)
class Split:
    """What takes the first item of what a loop goes through, what is left, and the tests of whether there is one."""
    first: Callable[[], Value]
    rest: Value
    tests: tuple[AST, ...]
    demands: frozenset[Fact] = frozenset()      # what would tell these


@dataclass(frozen=True)
class Peeled:
    """One round, behind which `rest` evaluates the others."""
    item: Callable[[], Value]
    rest: Callable[[], Any]

    def next(self) -> tuple[Value, _Rest]:
        return self.item(), _Rest(self.rest)


@dataclass(frozen=True)
class _Rest:
    rest: Callable[[], Any]

    def next(self) -> None:
        self.rest()


def peeled(ev: Evaluator, s: Any, f: Frame, split: Split, rest: Callable[[], Any], bind: Callable[[Value], None]
           ) -> None:
    """The first round, if there is one, and the others."""
    def rounds() -> None:
        ev.unrolled(s, Peeled(split.first, rest), f, bind)
    if not split.tests:
        rounds()
        return
    test = split.tests[0] if len(split.tests) == 1 else tree.BoolOp(tree.And(), list(split.tests))
    ev.branch(Data(tree.at(test, s), demands=split.demands), (rounds, lambda: None), s)


def split_iteration(ev: Evaluator, through: Value, node: AST) -> Split | None:
    """The first item apart, None where it cannot be had without the others."""
    if isinstance(through, Data) and through.is_list:
        length = tree.call("len", ev.spelled(through, node))
        return split_iteration(ev, Iteration("part", (through, Iteration("range", (constant(0), ev.named(
            Data(tree.at(length, node), shape=()), "stop", node))))), node)
    if isinstance(through, Iteration) and through.kind == "part":
        inner = split_iteration(ev, through.parts[1], node)
        if inner is None:
            return None
        return replace(inner, first=lambda: ev.atoms(
            ev.item_of(through.parts[0], inner.first(), node, ev.entry), "first", node),
            rest=replace(through, parts=(through.parts[0], inner.rest)))
    if isinstance(through, Data):
        base = ev.spelled(through, node)
        first = Data(tree.at(tree.index(base, tree.const(0)), node),
                     shape=through.shape[1:] if through.shape else None, origins=through.origins)
        rest = Data(tree.at(tree.index(tree.copy(base), tree.Slice(tree.const(1), None, None)), node),
                    origins=through.origins)
        test = tree.compare(tree.call("len", tree.copy(base)), tree.Gt(), tree.const(0))
        shape = ev.shape_of(through)
        if shape.is_known and shape.known and shape.known[0] == 0:
            return None
        tests = () if shape.is_known and shape.known else (test,)
        return Split(lambda: ev.named(first, "first", node), ev.named(rest, "rest", node), tests, shape.demands)
    if not isinstance(through, Iteration):
        return None
    if through.kind == "range":
        return _range(ev, through, node)
    if through.kind == "enumerate":
        return _enumerate(ev, through, node)
    if through.kind in ENDLESS:
        first = ev.item_at(through, constant(0), node, ev.entry)
        return Split(lambda: first, behind_first(through), ())
    if through.kind == "zip":
        inner = [split_iteration(ev, p, node) for p in through.parts]
        if not all(inner):
            return None
        found = [i for i in inner if i is not None]
        rest = Iteration("zip", tuple(i.rest for i in found))
        return Split(lambda: TupleValue(tuple(i.first() for i in found)), rest,
                     tuple(t for i in found for t in i.tests), frozenset().union(*(i.demands for i in found)))
    return None


def _range(ev: Evaluator, through: Iteration, node: AST) -> Split | None:
    bounds = through.parts if len(through.parts) > 1 else (constant(0), *through.parts)
    start, stop, step = (*bounds, constant(1))[:3]
    if not (isinstance(start, Data) and isinstance(stop, Data) and isinstance(step, Data)) or not isinstance(
            step.known, int) or not step.known:
        return None
    tests: tuple[AST, ...] = ()
    if not (start.is_known and stop.is_known):
        order = tree.Lt() if step.known > 0 else tree.Gt()
        tests = (tree.compare(ev.spelled(start, node), order, ev.spelled(stop, node)),)
    elif not range(start.known, stop.known, step.known):
        return None
    second = constant(start.known + step.known) if start.is_known else Data(tree.at(tree.add(
        ev.spelled(start, node), ev.spelled(step, node)), node))
    return Split(lambda: start, Iteration("range", (ev.named(second, "second", node), stop, step)), tests,
                 start.demands | stop.demands)


def _enumerate(ev: Evaluator, through: Iteration, node: AST) -> Split | None:
    inner = split_iteration(ev, through.parts[0], node)
    start = through.parts[1] if through.parts[1:] else constant(0)
    if inner is None or not isinstance(start, Data) or not isinstance(start.known, int):
        return None
    rest = Iteration("enumerate", (inner.rest, constant(start.known + 1)))
    return Split(lambda: TupleValue((start, inner.first())), rest, inner.tests, inner.demands)

