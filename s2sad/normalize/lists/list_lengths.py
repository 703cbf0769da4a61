"""list_lengths: how many items a list has at least where one of them is read, as far as the text shows it.

    us = [x[0]]                         1 item
    for k in range(n):
        us.append(x[k] * us[k])         us has k + 1 items, then k + 2
        if len(us) > 4:
            s += us[-5]                 at least 5
    for i in range(1, len(us)):
        s += us[i] - us[i - 1]          more than i

Requires resolved names. What is known to be inside is not asked of the run.
"""
from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field

from s2sad.infer.list_arrays import LISTED
from s2sad.normalize.lists.capacity import Capacity, own_part
from s2sad.normalize.lists.list_statements import appended_list, popped_list
from s2sad.tree import (
    AST, Add, And, Assign, BinOp, BoolOp, Break, Compare, Constant, Continue, Eq, For, FunctionDef, Gt, GtE, If, IfExp,
    List, Lt, LtE, Name, Not, NotEq, Or, Raise, Return, Sub, Subscript, Tuple, USub, UnaryOp, While, add, call_name,
    children, const, dump, indices, name, names, stored_names, walk, walk_statements,
)

_LEAVING = (Break, Continue, Raise, Return)
_MIRRORED: dict[type[AST], type[AST]] = {Gt: Lt, GtE: LtE, Lt: Gt, LtE: GtE}
_NEGATED: dict[type[AST], type[AST]] = {Gt: LtE, GtE: Lt, Lt: GtE, LtE: Gt, Eq: NotEq, NotEq: Eq}


@dataclass(frozen=True)
class _Place:
    """What holds at a place: how many items each list has at least, what the counters of loops are below, and how many
    items this iteration of the loop that fills a list has added to it."""
    least: Mapping[str, int] = field(default_factory=dict)
    stops: Mapping[str, AST] = field(default_factory=dict)
    added: Mapping[str, int] = field(default_factory=dict)


class ListLengths:
    """What is known of the lengths of lists at the places of one function."""

    def __init__(self, function: FunctionDef, made: Mapping[str, Assign], capacity: Capacity):
        self.function, self.made, self.capacity = function, made, capacity
        self.shrinking = {n for s in walk_statements(function.body) if (n := popped_list(s)) is not None} | {
            n for n in made if sum(n in stored_names([s]) for s in walk_statements(function.body)
                                   if isinstance(s, Assign)) > 1}
        self.in_step = _changes(function.body, made.keys())
        loops = {n: self._filling_loop(capacity.appends(function.body, n), s) for n, s in made.items()}
        self.filling = {n: loop for n, loop in loops.items() if loop is not None}
        self.fixed = {n for n, s in made.items() if call_name(s.value) == LISTED} - {
            n for s in walk_statements(function.body) for n in (appended_list(s), popped_list(s))}
        self.filled: set[int] = set()           # reads of lists behind the loops that fill them
        self.places: dict[int, _Place] = {}
        self._block(function.body, _Place(), frozenset())

    def append_index(self, listed: str) -> AST | None:
        """The index of an append by its loop's counter, where each iteration appends once and nothing else does."""
        return self._counted(listed, self._first(listed)) if listed in self.filling else None

    def exact(self, node: Subscript) -> AST | None:
        """How long a list is where one of its items is read, by the counter of the loop that fills it."""
        place, listed = self.places.get(id(node), _Place()), node.value.id
        return self._counted(listed, self._first(listed) + place.added[listed]) if listed in place.added else None

    def is_filled(self, node: Subscript) -> bool:
        """Whether the loop that fills a list is behind it where one of its items is read."""
        return id(node) in self.filled

    def is_fixed(self, listed: str) -> bool:
        """Whether a list is as long as it is made, `[None] * n`: its array has bounds of its own."""
        return listed in self.fixed

    def is_inside(self, node: Subscript) -> bool:
        """Whether an index is known to be less than the length of its list, or to count no further from its end."""
        index, listed, place = indices(node)[0], node.value.id, self.places.get(id(node), _Place())
        least = place.least.get(listed, 0)
        if isinstance(index, UnaryOp) and isinstance(index.op, USub) and isinstance(index.operand, Constant):
            return 1 <= index.operand.value <= least
        counter, beyond = _offset(index)
        if counter is None:
            return beyond is not None and 0 <= beyond < least
        if beyond is None:
            return False
        if listed in place.added and counter == self.filling[listed].target.id:
            return beyond < self._first(listed) + place.added[listed]
        return counter in place.stops and self._is_at_most(place.stops[counter], listed, -beyond)

    def _is_at_most(self, stop: AST, listed: str, more: int) -> bool:
        """Whether a number is at most the length of a list and so many more."""
        if call_name(stop) == "builtins.min":
            return any(self._is_at_most(a, listed, more) for a in stop.args)
        if call_name(stop) == "builtins.len":
            other = getattr(stop.args[0], "id", None)
            return more >= 0 and (other == listed or other in self.in_step and (
                self.in_step[other] == self.in_step.get(listed)))
        if isinstance(stop, BinOp) and (by := _shift(stop)) is not None:
            return self._is_at_most(stop.left, listed, more - by)
        bound = [s for s in walk_statements(self.function.body) if isinstance(stop, Name) and isinstance(s, Assign)
                 and stop.id in stored_names([s])]
        return len(bound) == self.capacity.intervals.store_count(getattr(stop, "id", "")) == 1 and (
            listed not in self.shrinking and not isinstance(bound[0].value, Name)
            and self._is_at_most(bound[0].value, listed, more))

    def _first(self, listed: str) -> int:
        return len(self.made[listed].value.elts)

    def _counted(self, listed: str, more: int) -> AST:
        counter = name(self.filling[listed].target.id)
        return add(counter, const(more)) if more else counter

    def _filling_loop(self, appends: list[list[AST]], made: Assign) -> For | None:
        inner = [s for s in appends[0] if not any(n is made for n in walk(s))] if len(appends) == 1 else []
        loop = inner[0] if len(inner) == 1 and isinstance(inner[0], For) else None
        if loop is None or call_name(loop.iter) != "builtins.range" or len(loop.iter.args) != 1 or not isinstance(
                made.value, (List, Tuple)) or made.targets[0].id in self.shrinking:
            return None
        if dump(self.capacity.widest_range(loop.iter)) != dump(loop.iter):
            return None             # its array has room for the longest that it becomes
        jumps = any(isinstance(n, (Break, Continue, Return)) for n in walk_statements(loop.body))
        return None if jumps or not isinstance(loop.target, Name) or loop.target.id in stored_names(loop.body) else loop

    # -- places ------------------------------------------------------------------------------------------------------

    def _block(self, block: list[AST], here: _Place, filled: frozenset[str]) -> _Place | None:
        """Notes what holds in a block; what holds behind it, or None if nothing is behind it."""
        for statement in block:
            if not isinstance(statement, While):        # asked again when the lists are others
                self._note(own_part(statement), here, filled)
            after = self._behind(statement, here, filled)
            if after is None:
                return None
            here = after
            filled |= {n for n, loop in self.filling.items() if loop is statement
                       and self.made.keys().isdisjoint(names(loop.iter))}       # whose lengths are less than their room
        return here

    def _behind(self, s: AST, here: _Place, filled: frozenset[str]) -> _Place | None:
        if isinstance(s, If):
            body = self._block(s.body, self._where(s.test, True, here), filled)
            other = self._block(s.orelse, self._where(s.test, False, here), filled)
            return other if body is None else body if other is None else _with(here, {
                n: min(body.least.get(n, 0), other.least.get(n, 0)) for n in body.least})
        if isinstance(s, (For, While)):
            return self._loop(s, here, filled)
        if isinstance(s, _LEAVING):
            return None
        grown, popped = appended_list(s), popped_list(s)
        if grown is not None:
            more = {grown: here.added[grown] + 1} if grown in here.added else {}
            return _Place({**here.least, grown: here.least.get(grown, 0) + 1}, here.stops, {**here.added, **more})
        if popped is not None:
            one = isinstance(s, Assign)
            return _with(here, {popped: max(here.least.get(popped, 0) - 1, 0) if one else 0})
        bound = {t.id for t in getattr(s, "targets", []) if isinstance(t, Name)} & self.made.keys()
        return _with(here, {n: len(getattr(s.value, "elts", [])) for n in bound}) if bound else here

    def _loop(self, loop: AST, here: _Place, filled: frozenset[str]) -> _Place:
        less = {n for s in walk_statements(loop.body) for n in (popped_list(s) or "", *(
            stored_names([s]) if isinstance(s, Assign) else ())) if n in self.made}
        here = _with(here, dict.fromkeys(less, 0))
        if isinstance(loop, While):
            self._note(loop.test, here, filled - less)
        own = {n: 0 for n, filling in self.filling.items() if filling is loop}
        inside = _Place(here.least, self._stops(loop, here, less), {**here.added, **own})
        inside = self._where(loop.test, True, inside) if isinstance(loop, While) else inside
        self._block(loop.body, inside, filled - less)
        self._block(loop.orelse, here, filled - less)
        times = getattr(loop.iter.args[0], "value", 0) if own else 0      # range(3): three more
        return _with(here, {n: here.least.get(n, 0) + max(times, 0) for n in own}) if type(times) is int else here

    def _stops(self, loop: AST, here: _Place, less: set[str]) -> dict[str, AST]:
        """What the counters are below that no list gets shorter than in a loop."""
        stops = {n: s for n, s in here.stops.items() if n not in stored_names([loop])}
        if isinstance(loop, For) and isinstance(loop.target, Name) and call_name(loop.iter) == "builtins.range" and (
                loop.target.id not in stored_names(loop.body)):
            args = loop.iter.args
            stops |= {loop.target.id: args[-1]} if len(args) < 3 else {}
        return {n: s for n, s in stops.items() if not less.intersection(names(s))}

    def _note(self, node: AST, here: _Place, filled: frozenset[str]) -> None:
        """Notes what holds at the reads of an expression or a statement without blocks."""
        if isinstance(node, Subscript) and isinstance(node.value, Name) and node.value.id in self.made:
            self.places[id(node)] = here
            if node.value.id in filled:
                self.filled.add(id(node))
        if isinstance(node, IfExp):
            self._note(node.test, here, filled)
            self._note(node.body, self._where(node.test, True, here), filled)
            self._note(node.orelse, self._where(node.test, False, here), filled)
        elif isinstance(node, BoolOp):
            for value in node.values:
                self._note(value, here, filled)
                here = self._where(value, isinstance(node.op, And), here)
        else:
            for part in children(node):
                self._note(part, here, filled)

    def _where(self, test: AST, holds: bool, here: _Place) -> _Place:
        """What holds where a test does, or does not."""
        if isinstance(test, UnaryOp) and isinstance(test.op, Not):
            return self._where(test.operand, not holds, here)
        if isinstance(test, BoolOp):
            for value in test.values if isinstance(test.op, And if holds else Or) else ():
                here = self._where(value, holds, here)
            return here
        listed, least = (test.id, int(holds)) if isinstance(test, Name) else _asked(test, holds)
        return _with(here, {listed: max(least, here.least.get(listed, 0))}) if listed in self.made else here


def _with(here: _Place, least: Mapping[str, int]) -> _Place:
    return _Place({**here.least, **least}, here.stops, here.added)


def _changes(block: list[AST], listed: Set[str]) -> dict[str, list[tuple[int, int, str]]]:
    """What changes the length of each list, and where: of those in step the same, side by side, as of the columns of
    one list of tuples."""
    found: dict[str, list[tuple[int, int, str]]] = {n: [] for n in listed}
    run = 0
    for s in block:
        grown, popped = appended_list(s), popped_list(s)
        bound = next((t.id for t in getattr(s, "targets", []) if isinstance(t, Name) and t.id in listed), None)
        if (changed := grown or popped or bound) not in found:
            run += 1
            for inner in (getattr(s, "body", []), getattr(s, "orelse", [])):
                for n, more in _changes(inner, listed).items():
                    found[n] += more
            continue
        what = "append" if grown else dump(s.value.args) if popped else str(len(
            s.value.elts)) if isinstance(s.value, (List, Tuple)) else dump(s.value)
        found[changed].append((id(block), run, what))
    return found


def _asked(test: AST, holds: bool) -> tuple[str, int]:
    """The list of whose length a test asks, and how long it is at least where the test holds, or does not."""
    if not isinstance(test, Compare) or len(test.ops) > 1:
        return "", 0
    left, right, kind = test.left, test.comparators[0], type(test.ops[0])
    if call_name(right) == "builtins.len":
        left, right, kind = right, left, _MIRRORED.get(kind, kind)
    kind = kind if holds else _NEGATED.get(kind, NotEq)
    bound = getattr(right, "value", None)
    if call_name(left) != "builtins.len" or type(bound) is not int:
        return "", 0
    least = {Gt: bound + 1, GtE: bound, Eq: bound}.get(kind, int(kind is NotEq and bound == 0))
    return getattr(left.args[0], "id", ""), least


def _shift(node: BinOp) -> int | None:
    """What `a + 2` or `a - 2` adds."""
    by = getattr(node.right, "value", None)
    if type(by) is not int or not isinstance(node.op, (Add, Sub)):
        return None
    return by if isinstance(node.op, Add) else -by


def _offset(index: AST) -> tuple[str | None, int | None]:
    """An index as a name and what is added to it; None for no name, None for another form."""
    if isinstance(index, Constant):
        return None, index.value if type(index.value) is int else None
    if isinstance(index, Name):
        return index.id, 0
    if isinstance(index, BinOp) and isinstance(index.left, Name):
        return index.left.id, _shift(index)
    return None, None


__all__ = ["ListLengths"]
