"""capacity: how long a list can become, as an expression where it is made.

    us = []                             p[0] = p[1]
    p[0] = p[1]                         stop = user.f(p)
    for k in range(user.f(p)):          us = []
        us.append(x[k])                 for k in range(stop):
                                            us.append(x[k])

Requires resolved names. A list that begins empty is made where it is first used (`sink_empty_lists`), and what a loop
that fills it calls is called once, before it. `Capacity` multiplies the trip counts of the loops around each append;
`IndexIntervals` says between which numbers an index lies, as far as the text shows it:

    k for k in range(1, n): 1 and more          t % 2: 0 to 1          1 - t % 2: 0 to 1
"""
from __future__ import annotations

from collections.abc import Callable
from functools import reduce

from s2sad.evaluate.argument_binding import user_call
from s2sad.evaluate.effects import parameters
from s2sad.evaluate.scope import KernelScope
from s2sad.normalize.lists.list_statements import popped_list
from s2sad.tree import (
    AST, Add, Assign, Attribute, BinOp, Constant, For, FunctionDef, If, List, Mod, Mult, Name, Store, Sub, Subscript,
    USub, UnaryOp, While, add, assign, at, call, call_name, const, copy, head_copy, name, names, stored_names,
    substitute, walk, walk_statements, with_body,
)

Appended = Callable[[AST], str | None]          # the name of the list that a statement appends to


def sink_empty_lists(tree: FunctionDef, scope: KernelScope, appended: Appended) -> FunctionDef:
    """The function in which lists that begin empty are made where they are first used."""
    grown = {n for s in walk(tree.body) if (n := appended(s)) is not None}
    return with_body(tree, _block(tree.body, grown, scope, appended) if grown else tree.body)


def _block(block: list[AST], grown: set[str], scope: KernelScope, appended: Appended) -> list[AST]:
    made: list[AST] = []
    waiting: list[Assign] = []
    for statement in block:
        if _starts_empty(statement, grown):
            waiting.append(statement)
            continue
        new = head_copy(statement)
        for field in ("body", "orelse"):
            if hasattr(statement, field):
                setattr(new, field, _block(getattr(statement, field), grown, scope, appended))
        if isinstance(new, For) and any(appended(s) is not None for s in walk(new.body)):
            made += _name_called_bounds(new, scope)
        used = {n.id for n in walk(new) if isinstance(n, Name)}
        made += [s for s in waiting if s.targets[0].id in used]
        waiting = [s for s in waiting if s.targets[0].id not in used]
        made.append(new)
    return [*made, *waiting]


def _starts_empty(statement: AST, grown: set[str]) -> bool:
    return isinstance(statement, Assign) and len(statement.targets) == 1 and isinstance(
        statement.targets[0], Name) and statement.targets[0].id in grown and isinstance(
        statement.value, List) and not statement.value.elts


def _name_called_bounds(loop: For, scope: KernelScope) -> list[AST]:
    """Names for the bounds of a range that are calls of kernels, which the loop reads."""
    calls = any(user_call(n) is not None for n in walk(loop.iter))
    if call_name(loop.iter) != "builtins.range" or not calls:
        return []
    before: list[AST] = []
    roles = ("stop",) if len(loop.iter.args) == 1 else ("start", "stop", "step")
    for position, (bound, role) in enumerate(zip(list(loop.iter.args), roles)):
        if not isinstance(bound, Constant):
            before.append(at(assign(new := scope.fresh(role), bound), loop))
            loop.iter.args[position] = at(name(new), bound)
    return before


class Capacity:
    """How long the lists of one function can become."""

    def __init__(self, function: FunctionDef, scope: KernelScope, appended: Appended):
        self.function, self.scope, self.appended = function, scope, appended
        self.intervals = IndexIntervals(function)
        self.order = {id(n): k for k, n in enumerate(walk(function.body))}

    def of(self, listed: str, made: Assign) -> AST | None:
        """How long a list can become, as an expression where it is made; None if that is not known there."""
        size: AST = const(len(made.value.elts))
        for loops in self.appends(self.function.body, listed):
            inner = [node for node in loops if not any(n is made for n in walk(node))]
            inner = [node for node in inner if not isinstance(node, If)]
            trips = [self.trip_count(inner[:k + 1], made) for k in range(len(inner))]
            if None in trips or not is_appended_only_after(made, self.function.body, self.appended):
                return None
            term = reduce(lambda a, b: BinOp(a, Mult(), b), trips) if trips else const(1)
            size = term if isinstance(size, Constant) and size.value == 0 else add(size, term)
        return size

    def appends(self, block: list[AST], listed: str, outer: tuple[AST, ...] = ()) -> list[list[AST]]:
        """For each append to a list the loops and branches that it is in."""
        found = [[*outer] for s in block if self.appended(s) == listed]
        for s in block:
            for field in ("body", "orelse"):
                if hasattr(s, field):
                    found += self.appends(getattr(s, field), listed, (*outer, s))
        return found

    def trip_count(self, loops: list[AST], made: Assign) -> AST | None:
        """How often the last of the loops runs at most, if that is known at a statement before them."""
        loop = loops[-1]
        found = _sequence_length(self.widest_range(loop.iter)) if isinstance(loop, For) else None
        if found is None or self.may_change(found, made, loops):
            return None
        return found if self.is_bound_before(found, made) else None

    def widest_range(self, iterable: AST) -> AST:
        """A range that goes from or to a counter of another loop, as wide as it becomes."""
        args = [copy(a) for a in getattr(iterable, "args", [])]
        if call_name(iterable) != "builtins.range" or len(args) > 2:
            return iterable
        if len(args) == 2 and self.intervals.is_nonnegative(args[0]) and not isinstance(args[0], Constant):
            args[0] = const(0)
        stops = {n: s for n in names(args[-1]) if (s := self.upper_bound(n)) is not None}
        plain = isinstance(args[-1], Name) or isinstance(args[-1], BinOp) and isinstance(
            args[-1].op, (Add, Sub)) and isinstance(args[-1].right, Constant)
        return call("builtins.range", *args[:-1], substitute(args[-1], stops) if plain else args[-1])

    def upper_bound(self, identifier: str) -> AST | None:
        """What the counter of a loop stays below."""
        loops = [s for s in walk_statements(self.function.body) if isinstance(s, For)
                 and identifier in stored_names(s.target)]
        if self.intervals.lower_bound(identifier) is None or len(loops) != 1:
            return None
        return self.widest_range(loops[0].iter).args[-1]

    def may_change(self, found: AST, made: Assign, loops: list[AST]) -> bool:
        """Whether what an expression reads may be stored into, or is a list that may get longer or shorter, between the
        statement that makes a list and the last time that the inner one of the loops around an append, the outermost
        first, goes by the expression."""
        first, last, memory = self.order[id(made)], self.order[id(loops[-1])], self.scope.memory
        again = {id(n) for n in walk(loops[0].body)} if len(loops) > 1 else set()
        between = [s for s in _statements(self.function.body)
                   if first < self.order[id(s)] < last or id(s) in again or last < first]
        lengths = {self.appended(s) or popped_list(s) for s in between}
        return bool(memory.written([found])) or not lengths.isdisjoint(names(found)) or memory.affected(
            found, memory.written([*map(own_part, between), *made.value.elts]))

    def is_bound_before(self, found: AST, made: Assign) -> bool:
        """Whether what an expression reads is bound before a statement, once."""
        for n in names(found):
            stores = [m for m in walk(self.function.body) if isinstance(m, Name) and m.id == n
                      and isinstance(m.ctx, Store)]
            if len(stores) > (n not in parameters(self.function)) or any(
                    self.order[id(m)] > self.order[id(made)] for m in stores):
                return False
        return True


def is_appended_only_after(made: Assign, block: list[AST], appended: Appended) -> bool:
    """Whether all that appends to a list follows in the block in which it is made, so that it is made before."""
    home = next(b for b in _blocks(block) if any(s is made for s in b))
    after = {id(s) for s in _statements(home[home.index(made) + 1:])}
    return all(id(s) in after for s in _statements(block) if appended(s) == made.targets[0].id)


def _sequence_length(iterable: AST) -> AST | None:
    """How long a sequence is, as an expression."""
    called, args = call_name(iterable), getattr(iterable, "args", [])
    if called == "builtins.range":
        plain = len(args) == 1 and isinstance(args[0], (Constant, Subscript, Attribute))
        return copy(args[0]) if plain else call("builtins.len", copy(iterable))
    if called in ("builtins.enumerate", "builtins.reversed") and args:
        return _sequence_length(args[0])
    if called == "builtins.zip" and args:
        found = [_sequence_length(a) for a in args]
        return None if None in found else found[0] if len(found) == 1 else call("builtins.min", *found)
    if isinstance(iterable, (Name, Subscript)):
        return call("builtins.len", copy(iterable))
    return None


def _blocks(block: list[AST]) -> list[list[AST]]:
    inner = [getattr(s, field) for s in block for field in ("body", "orelse") if hasattr(s, field)]
    return [block, *(b for i in inner for b in _blocks(i))]


def _statements(block: list[AST]) -> list[AST]:
    return [s for b in _blocks(block) for s in b]


def own_parts(block: list[AST]) -> list[AST]:
    """Every statement below, of those with blocks what is not in a block."""
    return [own_part(s) for s in _statements(block)]


def own_part(statement: AST) -> AST:
    """What of a statement is not in a block of its own."""
    if isinstance(statement, For):
        return statement.iter
    return statement.test if isinstance(statement, (If, While)) else statement


Interval = tuple[int | None, int | None]
_DEEPEST = 8


class IndexIntervals:
    """The names of one function and what binds them."""

    def __init__(self, function: FunctionDef):
        self.function = function

    def is_nonnegative(self, place: AST) -> bool:
        """Whether an index is never negative."""
        low, _ = self.interval(place)
        return low is not None and low >= 0

    def interval(self, node: AST, depth: int = 0) -> Interval:
        """What an integer is at least, and at most; None where that is not known."""
        if isinstance(node, Constant):
            return (node.value, node.value) if type(node.value) is int else (None, None)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            low, high = self.interval(node.operand, depth)
            return None if high is None else -high, None if low is None else -low
        if isinstance(node, Name):
            return self.of_name(node.id, depth)
        if not isinstance(node, BinOp):
            return None, None
        if isinstance(node.op, Mod):
            whole = type(getattr(node.right, "value", None)) is int and node.right.value > 0
            return (0, node.right.value - 1) if whole else (None, None)
        if not isinstance(node.op, (Add, Sub)):
            return None, None
        one, other = self.interval(node.left, depth), self.interval(node.right, depth)
        other = other if isinstance(node.op, Add) else other[::-1]
        sign = 1 if isinstance(node.op, Add) else -1
        low, high = (None if a is None or b is None else a + sign * b for a, b in zip(one, other))
        return low, high

    def of_name(self, identifier: str, depth: int) -> Interval:
        low = self.lower_bound(identifier)
        if low is not None or depth > _DEEPEST:
            return low, None
        bound = [s for s in walk_statements(self.function.body) if isinstance(s, Assign) and any(
            isinstance(t, Name) and t.id == identifier for t in s.targets)]
        once = len(bound) == self.store_count(identifier) == 1 and len(bound[0].targets) == 1
        return self.interval(bound[0].value, depth + 1) if once else (None, None)

    def store_count(self, identifier: str) -> int:
        parameter = any(p.id == identifier for p in self.function.args.args)
        return parameter + sum(isinstance(n, Name) and n.id == identifier and isinstance(n.ctx, Store)
                               for n in walk(self.function.body))

    def lower_bound(self, identifier: str) -> int | None:
        """The least value of a name that only loops over ranges with constant starts bind."""
        loops = [s for s in walk_statements(self.function.body) if isinstance(s, For) and isinstance(s.target, Name)
                 and s.target.id == identifier]
        if not loops or len(loops) != self.store_count(identifier):
            return None
        lows = [_range_start(s.iter) for s in loops]
        return None if None in lows else min(low for low in lows if low is not None)


def _range_start(iterable: AST) -> int | None:
    args = getattr(iterable, "args", [])
    if call_name(iterable) != "builtins.range" or len(args) == 3:
        return None
    if len(args) == 1:
        return 0
    return args[0].value if isinstance(args[0], Constant) and type(args[0].value) is int else None
