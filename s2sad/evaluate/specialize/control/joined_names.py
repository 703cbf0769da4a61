"""The names that joins bind on every way: the one that a slot had before, one that is made on a way, or a new one.

    if c: a, b = b, a              the slots of a and b exchange what they hold: all moves of a way happen at once
    if c: s = x[0]                 what is made on a way has the common name from the start
    else: s = x[1]
"""
from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.evaluator import Evaluator
from s2sad.evaluate.specialize.heap import Object, uses
from s2sad.evaluate.specialize.values import (
    UNKNOWN, Data, Reference, ResidualObject, TupleValue, Value, alike, count, parts, with_parts,
)
from s2sad.tree import AST

Objects = dict[int, Object]


@dataclass
class Way:
    """The end of one way: its heap, the statements on it, and what it returns."""
    objects: Objects
    block: list[AST]
    value: Value | None = None
    alternatives: tuple[int, ...] = ()      # of the choice that the ways decide


@dataclass
class Merged:
    """A slot that holds several things on several ways, under a preliminary name."""
    name: str
    wanted: str
    values: Sequence[tuple[Way, Data]]
    home: str = ""


def settled_names(ev: Evaluator, ways: Sequence[Way], merged: Sequence[Merged], since: int, origin: AST
                  ) -> dict[str, str]:
    """The names in place of preliminary ones; each way binds them at its end."""
    taken: set[str] = set()
    for m in merged:
        m.home = _kept(ev, ways, merged, m, taken)
        taken.add(m.home)
    for m in merged:
        m.home = m.home or _made_on_a_way(ev, ways, m, taken, since) or ev.fresh(m.wanted)
        taken.add(m.home)
    moves: dict[int, list[tuple[str, AST]]] = {}
    for m in merged:
        for way, v in m.values:
            if v.name != m.home and not _named_from_the_start(ev, ways, way, v, m.home, merged, since):
                moves.setdefault(id(way), []).append((m.home, tree.copy(v.node)))
    for way in ways:
        way.block += parallel(moves.get(id(way), []), origin)
    for m in merged:
        ev.rebound.append(m.home)
    return {m.name: m.home for m in merged}


def _kept(ev: Evaluator, ways: Sequence[Way], merged: Sequence[Merged], one: Merged, taken: set[str]) -> str:
    """The name of the user's variable, where it has one on some way that nothing else holds behind the join."""
    if len(one.values) < len(ways):
        return ""
    for name in sorted({v.name for _, v in one.values}, key=lambda name: ev.born.get(name, 0)):
        plain = name == one.wanted or re.sub(r"_\d+$", "", name) == one.wanted
        if not plain or name in taken or "." in name or name in ev.leaves or _is_returned(ways, name):
            continue
        if all(uses(w.objects, name) == sum(way is w and x.name == name for m in merged for way, x in m.values)
               for w in ways):
            return name
    return ""


def _made_on_a_way(ev: Evaluator, ways: Sequence[Way], one: Merged, taken: set[str], since: int) -> str:
    """A name that one way binds, and nothing else holds."""
    for way, v in one.values:
        if v.name and v.name not in taken and _is_own(ev, ways, way, v.name, since) and not any(
                uses(w.objects, v.name) for w in ways if w is not way):
            return v.name
    return ""


def _is_own(ev: Evaluator, ways: Sequence[Way], way: Way, name: str, since: int) -> bool:
    """Whether a name is made on a way and held by one slot there; loops that are left there hold nothing of it."""
    return ev.born.get(name, 0) > since and uses(way.objects, name) == 1 and not _is_returned(ways, name) and not any(
        uses(objects, name) for loop in ev.loops for _, _, objects in getattr(loop, "exits", ())) and any(
        isinstance(n, tree.Name) and n.id == name and not isinstance(n.ctx, tree.Load)
        for s in way.block for n in tree.walk(s))


def _is_returned(ways: Sequence[Way], name: str) -> bool:
    return any(w.value is not None and count(w.value, name) for w in ways)


def _named_from_the_start(ev: Evaluator, ways: Sequence[Way], way: Way, value: Data, home: str,
                          merged: Sequence[Merged], since: int) -> bool:
    """Gives what a way makes its common name where it is made; whether that is possible."""
    if not value.name or not _is_own(ev, ways, way, value.name, since) or any(m.home == value.name for m in merged):
        return False
    first = next(k for k, s in enumerate(way.block) if _mentions(s, value.name))
    made: Any = way.block[first]
    behind = way.block[first + 1:]
    simple = isinstance(made, tree.Assign) and len(made.targets) == 1 and isinstance(made.targets[0], tree.Name)
    if any(_mentions(s, home) for s in behind) or _mentions(made, home) and not simple or any(
            isinstance(n, (tree.Break, tree.Continue)) for s in [made, *behind] for n in tree.walk(s)):
        return False
    if any(count(x, home) for m in merged for w, x in m.values if w is way):
        return False        # which is still needed for another slot
    way.block[first:] = tree.rename(way.block[first:], {value.name: home})
    return True


def _mentions(node: AST, name: str) -> bool:
    return any(isinstance(n, tree.Name) and n.id == name for n in tree.walk(node))


def parallel(moves: Sequence[tuple[str, AST]], origin: AST) -> list[AST]:
    """Assignments that happen at once, one after the other where none reads what another has bound."""
    moves = [(t, v) for t, v in moves if not (isinstance(v, tree.Name) and v.id == t)]
    if not moves:
        return []
    read = [{n.id for n in tree.walk(v) if isinstance(n, tree.Name)} for _, v in moves]
    if any(t in r for k, (t, _) in enumerate(moves) for r in read[k + 1:]):
        targets = tree.tuple_of(*(tree.name(t) for t, _ in moves))
        return [tree.at(tree.assign(targets, tree.tuple_of(*(v for _, v in moves))), _place(moves[0][1], origin))]
    return [tree.at(tree.assign(t, v), _place(v, origin)) for t, v in moves]


def _place(value: AST, origin: AST) -> AST:
    """Where a slot got its value: that is what its move is about."""
    return value if isinstance(value, tree.Name) and getattr(value, "lineno", None) else origin


def same_things(objects: Objects, value: Value, others: Objects, other: Value, asked: frozenset[int] = frozenset()
                ) -> bool:
    """Whether two values of two heaps are the same, whatever is known of them, and what structures in them hold."""
    if not alike(plainly_named(value), plainly_named(other)):
        return False
    if isinstance(value, (TupleValue, ResidualObject)):
        return all(same_things(objects, v, others, o, asked) for v, o in zip(parts(value), parts(other)))
    if not isinstance(value, Reference) or value.number in asked:
        return True
    held, there = objects.get(value.number), others.get(value.number)
    return held is not None and there is not None and list(held.items) == list(there.items) and all(
        same_things(objects, v, others, there.items[k], asked | {value.number}) for k, v in held.items.items())


def plainly_named(value: Value) -> Value:
    """A value of which nothing is known but its names."""
    if isinstance(value, (TupleValue, ResidualObject)):
        return with_parts(value, [*map(plainly_named, parts(value))])
    return replace(value, known=UNKNOWN) if isinstance(value, Data) and value.name else value
