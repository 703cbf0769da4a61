"""Rows of written numbers by their columns: what each number is, of which kind a column's are, and the column's array.

    ((0, 0.5), (1, 0.25))       columns (0, 1) of integers and (0.5, 0.25) of floats
                                np.array((0, 1)), np.array((0.5, 0.25))
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from s2sad.read.constant_folding import folded
from s2sad.read.outside_values import Library, Meaning, NotConstant, Number
from s2sad.tree import AST, Constant, List, Name, Tuple, UnaryOp, call, const, copy, stored_names, tuple_of

Constants = Mapping[str, Any]
LARGEST = 2 ** 53       # integers beyond are not all floats
_KINDS = (("bool", (bool, numpy.bool_)), ("int", (int, numpy.integer)), ("float", (float, numpy.floating)))


def number(node: AST, constants: Constants) -> bool | int | float | None:
    """The number that is written, None for anything else."""
    def meaning(n: AST) -> Meaning | None:
        if not isinstance(n, Name):
            return None
        if n.id.startswith("const."):
            return Number(n.id, constants.get(n.id.removeprefix("const.")))
        return Library(n.id) if n.id.startswith(("numpy.", "math.")) else None
    try:
        value = folded(node, meaning)
    except NotConstant:
        return None
    return value if kind(value) else None


def kind(value: Any) -> str:
    """Of which kind a number is: "bool", "int", "float"; "" for anything else, and for an integer that is too large."""
    found = next((k for k, types in _KINDS if isinstance(value, types)), "")
    return "" if found == "int" and not -LARGEST < value < LARGEST else found


def column_kind(values: list[Any]) -> str:
    """The kind of a column's array: integers beside floats are floats; "" where bools stand beside others."""
    kinds = {kind(v) for v in values}
    return kinds.pop() if len(kinds) == 1 else "float" if kinds == {"int", "float"} else ""


@dataclass(frozen=True)
class Column:
    """The numbers that a loop's target goes through, of one kind, and their array."""
    values: list[Any]
    kind: str
    array: AST


def bound_columns(target: AST, items: list[AST], constants: Constants) -> dict[str, Column]:
    """The columns of what a loop goes through, by the targets that it binds to them; empty if any is none of numbers
    of one kind."""
    pairs = [dict(_pairs(target, item) or []) for item in items]
    found: dict[str, Column] = {}
    for word in pairs[0] if pairs and len(stored_names(target)) == len(pairs[0]) else {}:
        cells = [row.get(word) for row in pairs]
        values = [None if c is None else number(c, constants) for c in cells]
        of = "" if None in values else column_kind(values)
        if not of:
            return {}
        found[word] = Column(values, of, column([c for c in cells if c is not None], of, constants))
    return found


def _pairs(target: AST, item: AST) -> list[tuple[str, AST]] | None:
    """The names that an item is bound to, with its parts."""
    if isinstance(target, Name):
        return [(target.id, item)]
    several = isinstance(target, (Tuple, List)) and isinstance(item, (Tuple, List))
    if not several or len(target.elts) != len(item.elts):
        return None
    parts = [_pairs(t, i) for t, i in zip(target.elts, item.elts)]
    return None if None in parts else [pair for p in parts if p is not None for pair in p]


def rows(node: AST) -> list[list[AST]]:
    """The rows of a table that is written out, all of one length; empty for anything else."""
    if not isinstance(node, (List, Tuple)) or not node.elts:
        return []
    found = [list(r.elts) if isinstance(r, (List, Tuple)) else [] for r in node.elts]
    return found if all(found) and len({len(r) for r in found}) == 1 else []


def column(items: list[AST], wanted: str, constants: Constants) -> AST:
    """The array of a column; its numbers become those of a kind if that is `wanted`."""
    made = {"float": float, "int": int}.get(wanted)

    def cell(item: AST) -> AST:
        value = number(item, constants)
        if made is None or value is None or kind(value) == wanted:
            return copy(item)
        written = isinstance(item, (Constant, UnaryOp))
        return const(made(value)) if written else call(f"builtins.{wanted}", copy(item))
    return call("numpy.array", tuple_of(*map(cell, items)))
