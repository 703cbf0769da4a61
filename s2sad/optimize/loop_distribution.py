"""loop_distribution: increments of shared elements are buffered (array expansion), and added in a loop for each row.

    for j in range(n):                      for j in range(n):
        g = w[j] * seed[j]                      g = w[j] * seed[j]
        a_bar[i, j] += g                        a_bar_gains[j + 1] = g
        a_bar[i, j + 1] -= g                if 0 < n:
                                                for j in range(n + 1):
                                                    a_bar[i, j] = a_bar[i, j] - a_bar_gains[j] + a_bar_gains[j + 1]

*Establishes* that no iteration of one of the loops touches an element of another, so that all of them vectorize. An
element gets its increments in the order of the iterations; at the ends of a row, where fewer add to it, it gets zeros
from the margins of the buffers. (Kennedy, McKinley, SC 1990; gather form.) *Requires* an innermost counted loop. Only
rows of arrays of two axes or more, which fit a cache: a long vector would go through memory twice.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from s2sad.liveness import base_name
from s2sad.infer.types import Type
from s2sad.naming import Names
from s2sad.simplify.algebra import add_constant, simplify_index
from s2sad.optimize.loop_bounds import (
    CountedLoop, affine, bound_names, counted_loop, counter_offset, range_arguments, stored_elements,
)
from s2sad.tree import (
    AST, Add, Assign, AugAssign, BinOp, For, If, Lt, Name, Sub, Subscript, assign, at, augment, call, compare,
    const, copy, counted_for, dump, index, indices, name, names, walk,
)

CHANGES_ROUNDING = True


@dataclass
class DistributedLoops:
    """The loops that replace one, and the buffers to be allocated before them."""
    loops: list[AST] = field(default_factory=list)
    allocations: list[Assign] = field(default_factory=list)


def loop_distribution(loop: For, types: Mapping[str, Type], free: Names) -> DistributedLoops | None:
    """The loops for a loop that increments several elements of one row of an array; None if it does not."""
    bounds = counted_loop(loop)
    ends = bounds.ends() if bounds else None
    if bounds is None or ends is None or ends[0].terms or ends[0].constant < 0:
        return None
    arrays = [a for a in dict.fromkeys(base_name(s.target) for s in loop.body if _is_increment(s)) if a in types
              and types[a].is_float and _has_shared_elements(a, loop.body, bounds)]
    if not arrays:
        return None
    return _Distribution(loop, bounds, free).distribute(set(arrays))


def _is_increment(statement: AST) -> bool:
    return isinstance(statement, AugAssign) and isinstance(statement.op, (Add, Sub)) and isinstance(
        statement.target, Subscript)


def _has_shared_elements(array: str, body: list[AST], bounds: CountedLoop) -> bool:
    """Whether the loop only increments an array, and several iterations an element, by offsets from the counter or in
    several rows."""
    targets = [s.target for s in body if _is_increment(s) and base_name(s.target) == array]
    if sum(isinstance(n, Name) and n.id == array for n in walk(body)) != len(targets):
        return False
    bound = bound_names(body)
    for place in targets:
        *outer, last = indices(place)
        if not outer or counter_offset(last, bounds.counter) is None or {
                bounds.counter, *bound} & set(names(outer)) or any(affine(s) is None for s in outer):
            return False
    return len({dump(place) for place in targets}) > 1


@dataclass
class _RowIncrements:
    """The increments at one offset from the counter, each with its buffer, None where it is loop-invariant."""
    place: Subscript
    shift: int
    increments: list[tuple[AugAssign, str | None]] = field(default_factory=list)


class _Distribution:
    def __init__(self, loop: For, bounds: CountedLoop, free: Names):
        self.loop, self.bounds, self.free = loop, bounds, free
        self.result = DistributedLoops()
        self.rows: dict[str, tuple[str, set[str]]] = {}     # by a value's text: its row, and the names it is made of
        self.deferred: dict[str, _RowIncrements] = {}
        self.margin = 0

    def distribute(self, arrays: set[str]) -> DistributedLoops:
        """The loop that buffers the increments, then the loops that add them."""
        targets = [s.target for s in self.loop.body if _is_increment(s) and base_name(s.target) in arrays]
        self.margin = max(abs(self.shift(a) - self.shift(b)) for a in targets for b in targets
                          if _row_key(a) == _row_key(b))
        first: list[AST] = []
        for statement in self.loop.body:
            if _is_increment(statement) and any(statement.target is t for t in targets):
                first += self.defer(statement)
                continue
            first.append(statement)
            bound = bound_names([statement]) | {base_name(t) for t in stored_elements([statement])}
            self.rows = {text: row for text, row in self.rows.items() if not bound & row[1]}
        self.result.loops = [at(For(self.loop.target, self.loop.iter, first, [], None), self.loop)]
        self.result.loops += [at(s, self.loop) for group in self.fused_groups() for s in self.accumulating_loop(group)]
        return self.result

    def shift(self, place: Subscript) -> int:
        shift = counter_offset(indices(place)[-1], self.bounds.counter)
        assert shift is not None
        return shift

    def fused_groups(self) -> list[list[_RowIncrements]]:
        """The increments that one loop adds. An element gets its own in the order of the iterations: the furthest
        offset comes first; those of one row share a loop where the ones in between are in other rows."""
        made: list[list[_RowIncrements]] = []
        for row_increments in sorted(self.deferred.values(), key=lambda g: -self.bounds.step * g.shift):
            home = None
            for group in reversed(made):
                same_row = _row_key(group[0].place) == _row_key(row_increments.place)
                if same_row and _is_stored([*group, row_increments]):
                    home = group
                if home or not _are_distinct_rows(group[0].place, row_increments.place):
                    break
            if home is None:
                made.append([row_increments])
            else:
                home.append(row_increments)
        return made

    def accumulating_loop(self, group: list[_RowIncrements]) -> list[AST]:
        """The loop that adds the increments to a row."""
        counter, (start, stop) = self.bounds.counter, _both_bounds(self.bounds.upwards())
        if len(group) == 1:
            return [counted_for(counter, self.bounds.upwards(), [
                at(augment(s.target, s.op, self.stored_increment(row, 0) if row else s.value), s)
                for s, row in group[0].increments])]
        low, high = sorted((group[0].shift, group[-1].shift))
        place = next(g.place for g in group if g.shift == low)
        total: AST = copy(place)
        for row_increments in group:
            for increment, row in row_increments.increments:
                total = BinOp(total, copy(increment.op), self.stored_increment(row, low - row_increments.shift))
        bounds = range_arguments([copy(start), simplify_index(add_constant(copy(stop), high - low), integers=True)])
        loop = counted_for(counter, bounds, [at(assign(copy(place), total), group[0].increments[0][0])])
        return [If(compare(copy(start), Lt(), copy(stop)), [loop], [])]

    def stored_increment(self, row: str | None, shift: int) -> AST:
        """What the iteration at a distance of `shift` has stored in a buffer."""
        assert row is not None
        return index(name(row), simplify_index(add_constant(name(self.bounds.counter), self.margin + shift),
                                               integers=True))

    def defer(self, increment: AugAssign) -> list[AST]:
        """The store of the increment into its buffer; it is added later."""
        value, counter = increment.value, self.bounds.counter
        inside = {counter, *bound_names(self.loop.body)}
        made: list[AST] = []
        row = None
        if inside & set(names(value)) or any(isinstance(n, Subscript) for n in walk(value)):
            text = dump(value)
            if text not in self.rows:
                row = self.free.fresh(f"{base_name(increment.target)}_gains")
                self.rows[text] = row, set(names(value))
                self.result.allocations.append(assign(row, self.row_allocation()))
                made.append(at(assign(self.stored_increment(row, 0), value), increment))
            row = self.rows[text][0]
        target = increment.target
        same = self.deferred.setdefault(dump(target), _RowIncrements(copy(target), self.shift(target)))
        same.increments.append((increment, row))
        return made

    def row_allocation(self) -> AST:
        """A buffer with an element for every counter, and zeros in its margins."""
        size = self.bounds.extent()
        if not self.margin:
            return call("numpy.empty", size)
        return call("numpy.zeros", simplify_index(add_constant(size, 2 * self.margin), integers=True))


def _is_stored(group: list[_RowIncrements]) -> bool:
    """Whether all increments have buffers."""
    return all(row for row_increments in group for _, row in row_increments.increments)


def _row_key(place: Subscript) -> str:
    """The array and the subscripts of the other axes, as a text."""
    return f"{base_name(place)} {dump(indices(place)[:-1])}"


def _are_distinct_rows(a: Subscript, b: Subscript) -> bool:
    """Whether two elements are in different arrays or rows (or differ by the row before the first)."""
    if base_name(a) != base_name(b):
        return True
    for one, other in zip(indices(a)[:-1], indices(b)[:-1]):
        left, right = affine(one), affine(other)
        if left is not None and right is not None:
            distance = left.plus(right, -1)
            if not distance.terms and distance.constant:
                return True
    return False


def _both_bounds(bounds: list[AST]) -> list[AST]:
    return [const(0), *bounds] if len(bounds) == 1 else bounds
