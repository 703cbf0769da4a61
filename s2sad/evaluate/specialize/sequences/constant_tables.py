"""Tables: sequences of numbers that are known, of which a variable picks, are arrays of the residual program.

    w = (0.5, 0.25, 2.0)                w = np.array([0.5, 0.25, 2.0])
    for k in range(n):          ->      for k in range(n):
        s += w[k % 3] * x[k]                s += w[k % 3] * x[k]

Rows of numbers are one array, or one for each column where these are of several kinds. Those of a module are passed as
its arrays are. A row that is a list is no table's where anything else is done with it than to take its items: what is
picked is no list. Bools are none: those of an array are added as bools.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator, operation
from s2sad.evaluate.specialize.values import Data, Iteration, Reference, TupleValue, Value, constant
from s2sad.read.outside_values import Array
from s2sad.tree import AST

LONGEST = 16            # of a sequence of numbers whose loop is written out
_FEWEST = 4             # items of a loop that stays one, where it would be long written out
_LARGEST = 2 ** 53      # integers beyond are not all floats


@operation
def table_item(ev: Evaluator, base: Value, place: Value, node: AST) -> Value | None:
    """The item of a sequence that a variable picks; None where it holds anything but numbers, or rows of these."""
    if isinstance(base, TupleValue) and base.row is not None:
        array, first = base.row
        return _number(ev, array, TupleValue((first, place)), node)
    found = _Table.of(ev, base)
    of_lists = any(isinstance(i, Reference) for i in _items(ev, base) or ())
    if found is None or not isinstance(place, Data) or of_lists and node not in ev.spread:
        return None
    arrays = found.arrays(ev, _called(node), node)
    if not found.width:
        return _number(ev, arrays[0], place, node)
    if len(arrays) == 1:
        items = tuple(_number(ev, arrays[0], TupleValue((place, constant(k))), node) for k in range(found.width))
        return TupleValue(items, found.made, (arrays[0], place))
    return TupleValue(tuple(_number(ev, a, place, node) for a in arrays), found.made)


@operation
def through_tables(ev: Evaluator, value: Value, node: AST, longest: int = LONGEST) -> Value:
    """What a loop goes through, with long sequences of numbers as arrays."""
    if isinstance(value, Iteration) and value.kind in ("zip", "enumerate", "reversed"):
        return replace(value, parts=tuple(through_tables(ev, p, node, longest) for p in value.parts))
    found = _Table.of(ev, value)
    if found is None or len(found.rows) <= longest or found.made or getattr(value, "made", None):
        return value
    arrays = found.arrays(ev, _called(node), node)
    return ev.iterator("zip", *arrays) if len(arrays) > 1 else arrays[0]


@operation
def through_short_tables(ev: Evaluator, value: Value, loop: Any) -> Value | None:
    """The same with short sequences of numbers, of a loop that would be long written out; None of any other."""
    size = sum(isinstance(n, tree.stmt) for n in tree.walk(loop.body))
    columns = _columns(value)
    counts = [len(i) for c in columns for i in [_items(ev, c)] if i is not None]
    if len(counts) < len(columns) or not counts or min(counts) < _FEWEST or min(counts) * size <= LONGEST:
        return None
    made = through_tables(ev, value, loop.iter, 0)
    return made if ev.stays_one(made) else None


def _columns(value: Value) -> list[Value]:
    """What is gone through at once."""
    if not isinstance(value, Iteration) or value.kind not in ("zip", "enumerate", "reversed"):
        return [value]
    return [c for p in value.parts[:1 if value.kind == "enumerate" else None] for c in _columns(p)]


class _Table:
    """Rows of numbers, of which each column is of one kind; `width` is 0 where they are numbers."""

    def __init__(self, rows: Sequence[tuple[Data, ...]], width: int, made: Any):
        self.rows, self.width, self.made = rows, width, made
        self.kinds = [_kind([i.known for i in column]) for column in zip(*rows)]

    @classmethod
    def of(cls, ev: Evaluator, value: Value) -> _Table | None:
        """The table that a tuple or a list is, if it is one."""
        items = _items(ev, value)
        rows = [_items(ev, i) for i in items or ()]
        if items and all(r is None for r in rows):
            rows, width, made = [[i] for i in items], 0, None
        else:
            width, made = len(rows[0] or ()) if rows else 0, {getattr(i, "made", None) for i in items or ()}
            made = made.pop() if len(made) == 1 else None
            if not width or any(r is None or len(r) != width for r in rows):
                return None
        numbers = [tuple(i for i in r or () if isinstance(i, Data) and i.is_known) for r in rows]
        if any(len(r) != (width or 1) for r in numbers):
            return None
        found = cls(numbers, width, made)
        return found if all(found.kinds) else None

    def arrays(self, ev: Evaluator, wanted: str, node: AST) -> list[Data]:
        """The array of all numbers, or one for each column."""
        if len({*self.kinds}) == 1:
            rows = [list(r) for r in self.rows]
            return [_array(ev, rows if self.width else [r[0] for r in rows], self.kinds[0], wanted, node)]
        return [_array(ev, list(c), kind, f"{wanted}_{k}", node)
                for k, (c, kind) in enumerate(zip(zip(*self.rows), self.kinds))]


def _items(ev: Evaluator, value: Value) -> Sequence[Value] | None:
    if isinstance(value, TupleValue):
        return value.items
    held = ev.heap[value] if isinstance(value, Reference) else None
    return list(held.items.values()) if held is not None and held.kind == "list" else None


def _kind(numbers: Sequence[Any]) -> str:
    """Of which kind an array of these numbers is, "" of none; integers beside floats are floats."""
    kinds = {type(n).__name__ for n in numbers}
    if any(type(n) is int and not -_LARGEST < n < _LARGEST for n in numbers):
        return ""
    return kinds.pop() if len(kinds) == 1 and kinds <= {"int", "float"} else (
        "float" if kinds == {"int", "float"} else "")


def _array(ev: Evaluator, items: list[Any], kind: str, wanted: str, node: AST) -> Data:
    """The array of numbers, or of rows of these, made once in each function."""
    flat = [i for row in items for i in (row if isinstance(row, list) else [row])]
    known = [[i.known for i in row] if isinstance(row, list) else row.known for row in items]
    key = (kind, repr(known))
    shape = numpy.shape(known)
    negative = kind == "int" and any(i.known < 0 for i in flat)
    if all("." in i.name for i in flat):        # a module's
        made = ev.outside_tables.setdefault(key, Array(wanted, numpy.array(known, kind)))
        node = tree.at(tree.name(ev.outside_name_of(made)), node)
        return Data(node, shape=shape, is_signed=negative)
    if key not in ev.tables:
        make = float if kind == "float" else int
        rows = [tree.List([tree.literal(make(i.known)) for i in row], tree.Load()) if isinstance(row, list)
                else tree.literal(make(row.known)) for row in items]
        text = tree.call(ev.library("numpy.array"), tree.List(rows, tree.Load()))
        ev.tables[key] = ev.fresh(wanted), tree.at(text, node)
    return Data(tree.at(tree.name(ev.tables[key][0]), node), shape=shape, is_signed=negative)


def _number(ev: Evaluator, array: Data, place: Value, node: AST) -> Data:
    return Data(ev.subscripted(array, place, node), shape=(), is_signed=array.is_signed)


def _called(node: AST) -> str:
    """What the text calls what it picks from, or goes through."""
    node = node.args[0] if isinstance(node, tree.Call) and node.args else node
    while isinstance(node, tree.Subscript):
        node = node.value
    return node.id if isinstance(node, tree.Name) else node.attr if isinstance(node, tree.Attribute) else "table"


def lists_in(ev: Evaluator, value: Value) -> list[tuple[int, Any]]:
    """The lists that a loop goes through, with what they hold now."""
    if isinstance(value, Reference):
        return [(value.number, ev.heap[value].items)]
    return [found for part in (value.parts if isinstance(value, Iteration) else ()) for found in lists_in(ev, part)]


def with_tables(ev: Evaluator, body: list[AST]) -> list[AST]:
    """A function's statements behind those that make the tables which they read."""
    if not ev.tables:
        return body
    read = {n.id for n in tree.walk(body) if isinstance(n, tree.Name)}
    return [*(tree.at(tree.assign(name, text), text) for name, text in ev.tables.values() if name in read), *body]
