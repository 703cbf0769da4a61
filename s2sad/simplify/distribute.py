"""distribute: what iterations add to shared elements of a row is kept first, and added in a loop for each place.

    for j in range(n):                      for j in range(n):
        g = w[j] * seed[j]                      g = w[j] * seed[j]
        a_bar[i, j] += g                        a_bar_gains[j] = g
        a_bar[i, j + 1] += g                for j in range(n):
                                                a_bar[i, j + 1] += a_bar_gains[j]
                                            for j in range(n):
                                                a_bar[i, j] += a_bar_gains[j]

No iteration of any of these loops touches an element of another: all of them run in vectors. An element gets its
gains in the order in which the one loop adds them. (Loop distribution, array expansion: Kennedy, McKinley, SC 1990.)
Only for rows of arrays of two axes or more, which a cache holds: a long vector would go through memory twice.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from s2sad.analyze.liveness import base_name, targets
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import shifted, simple
from s2sad.simplify.bounds import Counted, affine, changed, counted, shifted_by, stores
from s2sad.tree import (
    AST, Add, Assign, AugAssign, Constant, For, Name, Sub, Subscript, assign, at, augment, call, const, copy,
    counted_for, dump, index, indices, name, names, walk,
)


@dataclass
class Distributed:
    """The loops that take the place of one, and the rows of gains to be allocated before them."""
    loops: list[AST] = field(default_factory=list)
    allocations: list[Assign] = field(default_factory=list)


def distributed(loop: For, types: Mapping[str, Type], free: Names) -> Distributed | None:
    """The loops for a loop that adds to several elements of one row of an array; None if it does not."""
    bounds = counted(loop)
    ends = bounds.ends() if bounds else None
    if bounds is None or ends is None or ends[0].terms or ends[0].constant < 0:
        return None
    arrays = [a for a in dict.fromkeys(base_name(s.target) for s in loop.body if _is_gain(s)) if a in types
              and types[a].is_float and _is_shared(a, loop.body, bounds)]
    if not arrays:
        return None
    return _Distribution(loop, bounds, free).made(set(arrays))


def _is_gain(statement: AST) -> bool:
    return isinstance(statement, AugAssign) and isinstance(statement.op, (Add, Sub)) and isinstance(
        statement.target, Subscript)


def _is_shared(array: str, body: list[AST], bounds: Counted) -> bool:
    """Whether the loop only adds to an array, in rows of which it visits an element more than once, by shifts of its
    counter, or in more than one row."""
    gained = [s.target for s in body if _is_gain(s) and base_name(s.target) == array]
    if sum(isinstance(n, Name) and n.id == array for n in walk(body)) != len(gained):
        return False
    bound = changed(body)
    for place in gained:
        *outer, last = indices(place)
        if not outer or shifted_by(last, bounds.counter) is None or {bounds.counter, *bound} & set(names(outer)) or any(
                affine(s) is None for s in outer):
            return False
    return len({dump(place) for place in gained}) > 1


class _Distribution:
    def __init__(self, loop: For, bounds: Counted, free: Names):
        self.loop, self.bounds, self.free = loop, bounds, free
        self.result = Distributed()
        self.rows: dict[str, tuple[str, set[str]]] = {}     # by a value's text: its row, and the names it is made of
        self.later: dict[str, list[AST]] = {}

    def made(self, arrays: set[str]) -> Distributed:
        """The loop that keeps gains, then the loops that add them."""
        first: list[AST] = []
        for statement in self.loop.body:
            if _is_gain(statement) and base_name(statement.target) in arrays:
                first += self.kept(statement)
                continue
            first.append(statement)
            bound = changed([statement]) | {base_name(t) for t in stores([statement])}
            self.rows = {text: row for text, row in self.rows.items() if not bound & row[1]}
        groups = sorted(self.later.values(), key=self.turn)
        self.result.loops = [at(For(self.loop.target, self.loop.iter, first, [], None), self.loop)]
        self.result.loops += [at(counted_for(self.bounds.counter, self.bounds.upwards(), gains), self.loop)
                              for gains in groups]
        return self.result

    def turn(self, gains: list[AST]) -> int:
        """An element's gains come from the iterations in their order: from the furthest shift first."""
        shift = shifted_by(indices(targets(gains[0])[0])[-1], self.bounds.counter)
        assert shift is not None
        return -self.bounds.step * shift

    def kept(self, gain: AugAssign) -> list[AST]:
        """What keeps the gain in its row; the gain itself comes later."""
        value, counter = gain.value, self.bounds.counter
        inside = {counter, *changed(self.loop.body)}
        made: list[AST] = []
        if inside & set(names(value)) or any(isinstance(n, Subscript) for n in walk(value)):
            text = dump(value)
            if text not in self.rows:
                row = self.free.fresh(f"{base_name(gain.target)}_gains")
                self.rows[text] = row, set(names(value))
                self.result.allocations.append(assign(row, call("numpy.empty", self.size())))
                made.append(at(assign(index(name(row), name(counter)), value), gain))
            value = index(name(self.rows[text][0]), name(counter))
        self.later.setdefault(dump(gain.target), []).append(at(augment(gain.target, gain.op, value), gain))
        return made

    def size(self) -> AST:
        """One more than the greatest counter."""
        start, stop = self.bounds.start, self.bounds.stop
        size = copy(stop) if self.bounds.step > 0 else simple(shifted(copy(start), 1), integers=True)
        return size if isinstance(size, (Subscript, Constant)) else call("builtins.max", size, const(0))
