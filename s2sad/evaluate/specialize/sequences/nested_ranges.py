"""Several numbers at once, by loops in loops: np.ndindex, np.ndenumerate, combinations of ranges.

    for i, j in itertools.combinations(range(n), 2):            for i in range(n):
        s += x[i, j]                                    ->          for j in range(i + 1, n):
                                                                        s += x[i, j]

Each is a generator function of nested loops over ranges: what is done with its items is evaluated in the innermost one.
"""
from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.heap import Object
from s2sad.evaluate.specialize.sequences.counted_sequence import list_parts
from s2sad.evaluate.specialize.values import (
    LARGEST_SEQUENCE, Data, Iteration, LibraryValue, Reference, TupleValue, Value, constant,
)
from s2sad.tree import AST

COMBINED = ("itertools.product", "itertools.combinations", "itertools.combinations_with_replacement")
NESTED = ("numpy.ndindex", "numpy.ndenumerate", *COMBINED)
RANGE, ARRAY, ITEMS, ROUND = ".range", ".array", ".items", ".round"
_AXES = "name the indices: for i, j in np.ndindex(x.shape)"


@operation
def gone_through(ev: Evaluator, node: Any, f: Frame) -> Value:
    """What a loop goes through; `np.ndindex(*x.shape)` is `np.ndindex(x.shape)`, of how many axes the target says."""
    star = node.args[0] if isinstance(node, tree.Call) and len(node.args) == 1 and not node.keywords else None
    if isinstance(star, tree.Starred) and ev.value(node.func, f) == LibraryValue("numpy.ndindex"):
        return ev.iterator("numpy.ndindex", ev.value(star.value, f))
    value = ev.value(node, f)
    if isinstance(value, Reference) and ev.heap[value].kind == "iterator":
        return ev.rest_of(value, node, f)
    return list_parts(value)


@operation
def nested(ev: Evaluator, through: Iteration, target: Any, node: AST, f: Frame) -> Iteration:
    """The same as a generator of nested loops, for a target that may say of how many."""
    names = _names(target.elts[0] if through.kind == "numpy.ndenumerate" and _is_pair(target) else target)
    held: dict[Hashable, Value] = {RANGE: LibraryValue("builtins.range")}
    ranges = _ranges(ev, through, len(names), node, held)
    if len(names) != len(ranges):
        names = [""] * len(ranges)
    counters = [n if n and names.count(n) == 1 else f"{n or 'index'}_{k}" for k, n in enumerate(names)]
    inner = replace(f, reference=ev.heap.new(Object("frame", held)), outer=f, is_entry=False,
                    local=frozenset({*counters, *map(str, held)}), nonlocals=frozenset())
    ev.frames.setdefault(inner.reference.number, inner)
    text = tree.at(_generator(through.kind, counters, ranges), node)
    definition = ev.loops_of.setdefault((node, tree.dump(text)), text)
    return Iteration("yields", (), (inner, definition), through.once)


@operation
def one_loop(ev: Evaluator, through: Value, target: Any, node: AST, f: Frame) -> Value:
    """What a loop goes through as a generator of one loop, which may be left for what is behind its `else`."""
    names = frozenset(n.id for n in tree.walk(target) if isinstance(n, tree.Name))
    held: dict[Hashable, Value] = {ITEMS: through}
    inner = replace(f, reference=ev.heap.new(Object("frame", held)), outer=f, is_entry=False, local=names | {ITEMS},
                    nonlocals=frozenset())
    ev.frames.setdefault(inner.reference.number, inner)
    item = tree.Expr(tree.Yield(tree.rebuild(target, _loaded)))
    loop = tree.For(tree.copy(target), tree.name(ITEMS), [item], [], None)
    text = tree.at(tree.FunctionDef("loop", None, [loop], [], None, None, []), node)
    return Iteration("yields", (), (inner, ev.loops_of.setdefault((node, "one"), text)))


@operation
def while_with_else(ev: Evaluator, s: Any, f: Frame) -> None:
    """The same of a `while`."""
    def texts() -> tuple[AST, AST]:
        rounds = tree.While(s.test, [tree.Expr(tree.Yield(None))], [])
        definition = tree.at(tree.FunctionDef("loop", None, [rounds], [], None, None, []), s)
        return definition, tree.at(tree.For(tree._target(tree.name(ROUND)), s.test, s.body, s.orelse, None), s)
    if (s, "else") not in ev.loops_of:
        ev.loops_of[s, "else"] = texts()
    definition, loop = ev.loops_of[s, "else"]
    ev.for_lazy(loop, Iteration("yields", (), (f, definition)), f)


def _loaded(node: AST) -> AST | None:
    return tree.at(tree.name(node.id), node) if isinstance(node, tree.Name) else (
        tree.at(tree.tuple_of(*(tree.rebuild(i, _loaded) for i in node.elts)), node)
        if isinstance(node, (tree.Tuple, tree.List)) else None)


def _generator(kind: str, counters: Sequence[str], ranges: Sequence[Sequence[AST]]) -> AST:
    """The text of the generator."""
    item: AST = tree.tuple_of(*map(tree.name, counters))
    if kind == "numpy.ndenumerate":
        item = tree.tuple_of(item, tree.index(tree.name(ARRAY), *map(tree.name, counters)))
    body: AST = tree.Expr(tree.Yield(item))
    for k in reversed(range(len(counters))):
        bounds = list(map(tree.copy, ranges[k]))
        if k and kind in COMBINED[1:]:
            low = tree.name(counters[k - 1])
            step = bounds[2] if len(bounds) == 3 else tree.const(1)
            first = low if kind.endswith("replacement") else tree.add(low, step)
            bounds = [first, *(bounds[1:] if len(bounds) > 1 else bounds)]
        body = tree.For(tree._target(tree.name(counters[k])), tree.call(RANGE, *bounds), [body], [], None)
    return tree.FunctionDef("nested", None, [body], [], None, None, [])


def _is_pair(target: Any) -> bool:
    return isinstance(target, (tree.Tuple, tree.List)) and len(target.elts) == 2


def _names(target: Any) -> list[str]:
    """The names that a target takes the numbers with, "" for what is none; nothing for a single one."""
    return [t.id if isinstance(t, tree.Name) else "" for t in target.elts] if isinstance(
        target, (tree.Tuple, tree.List)) else []


def _ranges(ev: Evaluator, through: Iteration, wanted: int, node: AST, held: dict[Hashable, Value]
            ) -> list[list[AST]]:
    """The bounds of the ranges, under names that are held; raises Unevaluated where how many there are is not known."""
    def named(*bounds: Value) -> list[AST]:
        start = len(held)
        held.update({f".{start + k}": ev.atoms(b, "stop", node) for k, b in enumerate(bounds)})
        return [tree.name(f".{start + k}") for k in range(len(bounds))]
    if through.kind in COMBINED:
        given = [p.parts for p in through.parts if isinstance(p, Iteration)]
        rows = [named(*parts) for parts in given]
        return rows * through.more
    only = through.parts[0] if len(through.parts) == 1 else TupleValue(through.parts)
    if through.kind == "numpy.ndenumerate":
        held[ARRAY] = ev.atoms(only, "items", node)
        only = ev.attribute_of(held[ARRAY], "shape", node, ev.entry)
    if isinstance(only, TupleValue):
        return [named(p) for p in only.items]
    if isinstance(only, Data) and (only.shape == () or type(only.known) is int):
        return [named(only)]
    if isinstance(only, Data) and isinstance(only.node, tree.Attribute) and isinstance(only.node.value, tree.Name):
        count = _axes(ev, only, wanted, node)       # of an array: its lengths stay what they are
        held.setdefault(ARRAY, Data(only.node.value))
        return [[tree.index(tree.attribute(tree.name(ARRAY), "shape"), tree.const(k))] for k in range(count)]
    only = ev.atoms(only, "items", node)
    return [named(ev.item_of(only, constant(k), node, ev.entry)) for k in range(_axes(ev, only, wanted, node))]


def _axes(ev: Evaluator, shape: Value, wanted: int, node: AST) -> int:
    """How many axes a shape has."""
    count = len(shape.known) if isinstance(shape, Data) and isinstance(shape.known, tuple) else (
        shape.count if isinstance(shape, Data) else None)
    if count is None and not wanted:
        raise ev.unknown(node, "np.ndindex over an unknown number of axes", shape, help=_AXES)
    return wanted if count is None else count


@operation
def nested_items(ev: Evaluator, through: Iteration, node: AST, f: Frame) -> list[Value]:
    """All items, of sequences that are known."""
    if through.kind in COMBINED:
        made, count = getattr(itertools, through.kind.partition(".")[2]), through.more
        items = [list(enumerate(ev.all_items(p, node, f))) for p in through.parts]
        return rows_of(ev, made(*items, repeat=count) if through.kind == COMBINED[0] else made(*items, count), node)
    if through.kind != "numpy.ndindex":
        raise ev.unknown(node, "how many items there are must be known before the run")
    lengths = through.parts[0] if len(through.parts) == 1 else TupleValue(through.parts)
    known = ev.known(lengths, node, "how many items there are")
    places = itertools.product(*map(range, known if isinstance(known, tuple) else (known,)))
    return [TupleValue(tuple(map(constant, place))) for place in places]


def rows_of(ev: Evaluator, rows: Iterator[Any], node: AST) -> list[Value]:
    """Rows of numbered values as tuples; refuses many."""
    found: list[Value] = [TupleValue(tuple(v for _, v in row))
                          for row in itertools.islice(rows, LARGEST_SEQUENCE + 1)]
    ev.counted(found, node)
    return found
