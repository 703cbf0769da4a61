"""distribute: what iterations add to shared elements of a row is kept first, and added in a loop for each row.

    for j in range(n):                      for j in range(n):
        g = w[j] * seed[j]                      g = w[j] * seed[j]
        a_bar[i, j] += g                        a_bar_gains[j + 1] = g
        a_bar[i, j + 1] -= g                if 0 < n:
                                                for j in range(n + 1):
                                                    a_bar[i, j] = a_bar[i, j] - a_bar_gains[j] + a_bar_gains[j + 1]

No iteration of any of these loops touches an element of another: all of them run in vectors. An element gets its
gains in the order in which the one loop adds them; where fewer iterations add to it, at the ends of a row, it gets
zeros from the margins of the rows of gains. (Loop distribution, array expansion: Kennedy, McKinley, SC 1990; gather
form.) Only for rows of arrays of two axes or more, which a cache holds: a long vector would go through memory twice.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from s2sad.analyze.liveness import base_name
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import shifted, simple
from s2sad.simplify.bounds import Counted, affine, changed, counted, shifted_by, spelled, stores
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, Constant, For, If, Lt, Name, Sub, Subscript, assign, at, augment, call, compare,
    const, copy, counted_for, dump, index, indices, name, names, walk,
)

CHANGES_ROUNDING = True


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


@dataclass
class _Gains:
    """Gains of one place by one shift of the counter: each with its row, None where it is the same for all counters."""
    place: Subscript
    shift: int
    given: list[tuple[AugAssign, str | None]] = field(default_factory=list)


class _Distribution:
    def __init__(self, loop: For, bounds: Counted, free: Names):
        self.loop, self.bounds, self.free = loop, bounds, free
        self.result = Distributed()
        self.rows: dict[str, tuple[str, set[str]]] = {}     # by a value's text: its row, and the names it is made of
        self.later: dict[str, _Gains] = {}
        self.margin = 0

    def made(self, arrays: set[str]) -> Distributed:
        """The loop that keeps gains, then the loops that add them."""
        gains = [s for s in self.loop.body if _is_gain(s) and base_name(s.target) in arrays]
        self.margin = max(abs(self.shift(a.target) - self.shift(b.target)) for a in gains for b in gains
                          if _row(a.target) == _row(b.target))
        first: list[AST] = []
        for statement in self.loop.body:
            if any(statement is g for g in gains):
                first += self.kept(statement)
                continue
            first.append(statement)
            bound = changed([statement]) | {base_name(t) for t in stores([statement])}
            self.rows = {text: row for text, row in self.rows.items() if not bound & row[1]}
        self.result.loops = [at(For(self.loop.target, self.loop.iter, first, [], None), self.loop)]
        self.result.loops += [at(s, self.loop) for group in self.groups() for s in self.added(group)]
        return self.result

    def shift(self, place: Subscript) -> int:
        shift = shifted_by(indices(place)[-1], self.bounds.counter)
        assert shift is not None
        return shift

    def groups(self) -> list[list[_Gains]]:
        """The gains that one loop adds. An element's gains come from the iterations in their order: from the furthest
        shift first; those of a row come together where what comes between is in other rows."""
        made: list[list[_Gains]] = []
        for gains in sorted(self.later.values(), key=lambda g: -self.bounds.step * g.shift):
            home = None
            for group in reversed(made):
                if _row(group[0].place) == _row(gains.place) and _is_kept(group) and _is_kept([gains]):
                    home = group
                if home or not _apart(group[0].place, gains.place):
                    break
            if home is None:
                made.append([gains])
            else:
                home.append(gains)
        return made

    def added(self, group: list[_Gains]) -> list[AST]:
        """The loop that adds gains to a row."""
        counter, (start, stop) = self.bounds.counter, _two(self.bounds.upwards())
        if len(group) == 1:
            return [counted_for(counter, self.bounds.upwards(), [
                at(augment(gain.target, gain.op, self.gain(row, 0) if row else gain.value), gain)
                for gain, row in group[0].given])]
        low, high = sorted((group[0].shift, group[-1].shift))
        place = next(g.place for g in group if g.shift == low)
        total: AST = copy(place)
        for gains in group:
            for gain, row in gains.given:
                total = BinOp(total, copy(gain.op), self.gain(row, low - gains.shift))
        bounds = spelled([copy(start), simple(shifted(copy(stop), high - low), integers=True)])
        loop = counted_for(counter, bounds, [at(assign(copy(place), total), group[0].given[0][0])])
        return [If(compare(copy(start), Lt(), copy(stop)), [loop], [])]

    def gain(self, row: str | None, shift: int) -> AST:
        """The gain that an iteration so far behind has kept."""
        assert row is not None
        return index(name(row), simple(shifted(name(self.bounds.counter), self.margin + shift), integers=True))

    def kept(self, gain: AugAssign) -> list[AST]:
        """What keeps the gain in its row; the gain itself comes later."""
        value, counter = gain.value, self.bounds.counter
        inside = {counter, *changed(self.loop.body)}
        made: list[AST] = []
        row = None
        if inside & set(names(value)) or any(isinstance(n, Subscript) for n in walk(value)):
            text = dump(value)
            if text not in self.rows:
                row = self.free.fresh(f"{base_name(gain.target)}_gains")
                self.rows[text] = row, set(names(value))
                self.result.allocations.append(assign(row, self.allocation()))
                made.append(at(assign(self.gain(row, 0), value), gain))
            row = self.rows[text][0]
        gains = self.later.setdefault(dump(gain.target), _Gains(copy(gain.target), self.shift(gain.target)))
        gains.given.append((gain, row))
        return made

    def allocation(self) -> AST:
        """A row with a place for every counter, and zeros in its margins."""
        start, stop = self.bounds.start, self.bounds.stop
        size = copy(stop) if self.bounds.step > 0 else simple(shifted(copy(start), 1), integers=True)
        size = size if isinstance(size, (Subscript, Constant)) else call("builtins.max", size, const(0))
        if not self.margin:
            return call("numpy.empty", size)
        return call("numpy.zeros", simple(shifted(size, 2 * self.margin), integers=True))


def _is_kept(group: list[_Gains]) -> bool:
    """Whether all gains have rows."""
    return all(row for gains in group for _, row in gains.given)


def _row(place: Subscript) -> str:
    """The array and the subscripts of the other axes, as a text."""
    return f"{base_name(place)} {dump(indices(place)[:-1])}"


def _apart(a: Subscript, b: Subscript) -> bool:
    """Whether two places are in different arrays or rows (or differ by the row before the first)."""
    if base_name(a) != base_name(b):
        return True
    for one, other in zip(indices(a)[:-1], indices(b)[:-1]):
        left, right = affine(one), affine(other)
        if left is not None and right is not None:
            distance = left.plus(right, -1)
            if not distance.terms and distance.constant:
                return True
    return False


def _two(bounds: list[AST]) -> list[AST]:
    return [const(0), *bounds] if len(bounds) == 1 else bounds
