"""The run of a generated text without content: what it allocates, trip by trip only where trips differ.

A loop is run once for all of its trips, in which its counter and the numbers that it changes are what they may be
(`Between`), and numbers that it counts up are known relatively to where a trip began. Where the memory turns out to
depend on the trip, as in triangles, the loop is run again trip by trip, if it is not too long; else bounds are kept. A
branch that data decide is run both ways.
"""
from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from s2sad.program import SnapshotLoop
from s2sad.run.memory.abstract_arrays import Array, KeptList, Meter
from s2sad.run.memory.abstract_expressions import Expressions, either
from s2sad.run.memory.allocating_functions import Trips
from s2sad.run.memory.growing_stacks import Frame, Stacks, count_of_entries
from s2sad.run.memory.inert_statements import InertStatements, allocated_name, deciding, unwritten
from s2sad.run.memory.interval_arithmetic import (
    INF, UNKNOWN, Between, bounds, joined, loops_of_values, operated, truth,
)
from s2sad.run.memory.while_trips import trips_of

_STATEMENTS = 50_000       # how many are run trip by trip, all in all
_FEW = 1_000                # how many where only what lives for a statement differs
_DEEPEST = 40               # calls


class MemoryInterpreter:
    """The functions of a text; `kinds` says of some of their names that they hold a tape, or snapshots, `loops` are
    those that keep snapshots."""

    def __init__(self, functions: Mapping[str, ast.FunctionDef], constants: Mapping[str, Any],
                 kinds: Mapping[tuple[str, str], str], loops: Iterable[SnapshotLoop]):
        self.functions, self.kinds, self.loops = functions, kinds, {loop.function: loop for loop in loops}
        self.meter = Meter()
        self.expressions = Expressions(self.meter, functions, constants, self.call)
        self.stacks = Stacks(self.meter, kinds)
        self.steps: dict[str, Any] = {}
        self.rows: dict[str, int] = {}      # that snapshots of a function fill
        self.inert = InertStatements()
        self.left, self.depth, self.may_leave = _STATEMENTS, 0, False

    def call(self, name: str, args: list[Any]) -> Any:
        """What a function of the text returns."""
        if self.depth >= _DEEPEST:
            return UNKNOWN
        loop = self.loops.get(name)
        if loop is None:
            return self.run(name, args).returned
        given, state = None if loop.is_counted else [*args], (self.meter.state(), self.stacks.state())
        frame = self.run(name, args)
        steps = frame.scope.get(loop.steps, UNKNOWN)
        if given is not None:
            low, high = bounds(steps)
            if low < high:
                self.meter.bounded |= low <= loop.snapshots.count
            elif high <= loop.snapshots.count:      # the rows behind these are not touched
                del frame
                self.meter.restore(state[0])
                self.stacks.found = state[1]
                self.rows[name] = int(high)
                frame = self.run(name, given)
                del self.rows[name]
        self.steps[name] = steps if name not in self.steps else either(self.steps[name], steps)
        return frame.returned

    def run(self, name: str, args: list[Any]) -> Frame:
        """A function of the text, as it is left."""
        function = self.functions[name]
        frame = Frame(name, dict(zip((p.arg for p in function.args.args), args)))
        args.clear()        # the scope has them
        outer, self.may_leave = self.may_leave, False
        self.depth += 1
        self.meter.events += 1
        self.block(function.body, frame)
        self.depth -= 1
        self.may_leave = outer
        return frame

    def block(self, block: list[ast.stmt], frame: Frame) -> str:
        """Runs statements; how they are left: "" at their end, else "break", "continue", "return" or "raise"."""
        for statement in block:
            if statement in self.inert.found:
                continue
            self.left -= 1
            events = self.meter.events
            how = getattr(self, f"_{type(statement).__name__}", self._nothing)(statement, frame)
            if how:
                return how
            if events == self.meter.events:
                self.inert.note(statement, self.functions[frame.function])
        return ""

    def _nothing(self, statement: ast.stmt, frame: Frame) -> str:
        return ""

    def _Break(self, statement: ast.Break, frame: Frame) -> str:
        return "break"

    def _Continue(self, statement: ast.Continue, frame: Frame) -> str:
        return "continue"

    def _Raise(self, statement: ast.Raise, frame: Frame) -> str:
        return "raise"

    def _Return(self, statement: ast.Return, frame: Frame) -> str:
        frame.returned = None if statement.value is None else _named(self.expressions.value(statement.value,
                                                                                            frame.scope))
        return "return"

    def _Expr(self, statement: ast.Expr, frame: Frame) -> str:
        call = statement.value
        if isinstance(call, ast.Call) and (name := _list_of(call)):
            self.stacks.append(frame, name, _named(self.expressions.value(call.args[0], frame.scope)))
        else:
            self.expressions.value(call, frame.scope)
        return ""

    def _Assign(self, statement: ast.Assign, frame: Frame) -> str:
        value, target = statement.value, statement.targets[0]
        own = target.id if isinstance(target, ast.Name) else ""
        if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "grow":
            self.stacks.grow(frame, own, self.expressions.value(value.args[1], frame.scope))
            return ""
        if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "list":
            frame.scope[own] = KeptList((0,), np.dtype("V0"))
            frame.scope[count_of_entries(own)] = 0
            return ""
        kind = self.kinds.get((frame.function, own), "work")
        rows = self.rows.get(frame.function) if kind == "snapshots" else None
        if allocated_name(statement) in unwritten(self.functions[frame.function]):
            rows = 0
        with self.meter.making(kind, rows):
            found = self.expressions.value(value, frame.scope)
        for each in statement.targets:
            self.bind(each, found, frame)
        return ""

    def _AugAssign(self, statement: ast.AugAssign, frame: Frame) -> str:
        value = self.expressions.value(statement.value, frame.scope)
        target = statement.target
        if isinstance(target, ast.Name) and not isinstance(frame.scope.get(target.id), Array):
            before = frame.scope.get(target.id, UNKNOWN)
            self.bind(target, self.expressions.operation(statement.op, before, value), frame)
        elif isinstance(target, ast.Subscript):
            self.expressions.value(ast.Subscript(target.value, target.slice, ast.Load()), frame.scope)
        return ""

    def bind(self, target: ast.expr, value: Any, frame: Frame) -> None:
        if isinstance(target, ast.Name):
            frame.scope[target.id] = value = _named(value)
            self.meter.events += isinstance(value, (Array, tuple))
            kind = self.kinds.get((frame.function, target.id))
            if kind is not None and isinstance(value, Array) and value.buffer is not None:
                value.buffer.tag(kind if value.buffer.kind != "disk" else "disk")
                self.stacks.noted(frame, target.id, value)
                if any(isinstance(e, Between) and not e.reached for e in value.shape):
                    self.stacks.differs(loops_of_values(*value.shape))
        elif isinstance(target, ast.Subscript) and isinstance(target.value, ast.Name):
            self.stacks.holds(frame, target.value.id, value)
        elif isinstance(target, (ast.Tuple, ast.List)):
            several = isinstance(value, tuple) and len(value) == len(target.elts)
            for k, each in enumerate(target.elts):
                self.bind(each, value[k] if several else UNKNOWN, frame)

    def _If(self, statement: ast.If, frame: Frame) -> str:
        known = truth(test := self.expressions.value(statement.test, frame.scope))
        if known is not None:
            return self.block(statement.body if known else statement.orelse, frame)
        before, held = dict(frame.scope), self.meter.live
        how = self.block(statement.body, frame)
        first, frame.scope = frame.scope, before
        parked = self.meter.live - held         # what the one way has made is not there on the other
        self.meter.live -= parked
        other = self.block(statement.orelse, frame)
        self.meter.live += parked
        return self.join(frame, first, how, other, loops_of_values(test))

    def join(self, frame: Frame, first: dict[str, Any], how: str, other: str, loops: frozenset[int]) -> str:
        """Where two ways meet, or one of them leaves."""
        second, frame.scope = frame.scope, {}
        if bool(how) != bool(other):
            self.may_leave = self.may_leave or "raise" not in (how, other)
            frame.scope = second if how else first
            return ""
        for name in {**first, **second}:
            a, b = first.get(name), second.get(name)
            frame.scope[name] = b if name not in first else a if name not in second else either(a, b)
            if isinstance(a, Array) and isinstance(b, Array) and a.pushed is not b.pushed and a.pushed != b.pushed:
                self.stacks.differs(loops)
                frame.scope[name] = replace(a if bounds(a.pushed)[1] >= bounds(b.pushed)[1] else b, pushed=_later(
                    a.pushed, b.pushed))
            elif isinstance(frame.scope[name], Between) and loops and a is not b:
                frame.scope[name] = replace(frame.scope[name], loops=frame.scope[name].loops | loops)
        return how if how == other or other == "raise" else other

    # -- loops ---------------------------------------------------------------------------------------------------------

    def _For(self, statement: ast.For, frame: Frame) -> str:
        trips = self.expressions.value(statement.iter, frame.scope)
        if isinstance(trips, Array):
            trips = Trips(trips.shape[0])
        if not isinstance(trips, Trips):
            trips = Trips(UNKNOWN)
        if bounds(trips.count)[1] <= 0:
            return ""
        if not any(isinstance(p, Between) for p in trips.bounds) and trips.count < 3:
            return self.trip_by_trip(statement, trips, frame)
        before, state = dict(frame.scope), self.meter.state()
        how = self.all_at_once(statement, frame, trips.count, trips)
        known = not any(isinstance(p, Between) for p in trips.bounds)
        cost = trips.count * _length(statement) if known else INF
        differ = id(statement) in self.meter.loops or self.counts_vaguely(statement, frame, before)
        if differ and cost <= self.left or id(statement) in self.meter.vague and cost <= _FEW:
            frame.scope.clear()
            frame.scope.update(before)
            before.clear()
            self.meter.restore(state)
            return self.trip_by_trip(statement, trips, frame)
        return how

    def counts_vaguely(self, loop: ast.For, frame: Frame, before: Mapping[str, Any]) -> bool:
        """Whether a loop counts up something that decides, differently from trip to trip."""
        deciding_names = deciding(self.functions[frame.function])
        return any(isinstance(v := frame.scope.get(n), Between) and id(loop) in v.loops for n in _stored(loop)
                   if n in before and n in deciding_names)

    def _While(self, statement: ast.While, frame: Frame) -> str:
        if truth(self.expressions.value(statement.test, frame.scope)) is False:
            return ""
        return self.all_at_once(statement, frame, Between(0, INF), None)

    def trip_by_trip(self, statement: ast.For, trips: Trips, frame: Frame) -> str:
        parts = [int(p) for p in trips.bounds]
        for value in range(*parts):
            self.bind(statement.target, value, frame)
            how = self.block(statement.body, frame)
            if how in ("return", "raise"):
                return how
            if how == "break":
                break
        return ""

    def all_at_once(self, statement: ast.For | ast.While, frame: Frame, count: Any, trips: Trips | None) -> str:
        """One trip that stands for all of them."""
        ident, scope = id(statement), frame.scope
        entry = {n: scope[n] for n in _stored(statement) if n in scope and not isinstance(scope[n], (Array, tuple))}
        arrays = {n: scope.get(n) for n in _stored(statement)}
        outer, self.may_leave = self.may_leave, False
        how = self.one_trip(statement, frame, entry, trips)
        rebound = any(_is_rebound(scope.get(n), a) for n, a in arrays.items() if (frame.function, n) not in self.kinds)
        if rebound and not how:     # what a trip finds of the one before lives until it is replaced
            how = self.one_trip(statement, frame, entry, trips)
        if isinstance(statement, ast.While):
            count = trips_of(statement.test, ident, entry, frame.scope, self.expressions.value) or count
        if self.may_leave or how in ("break", "return"):
            count = Between(min(1, bounds(count)[0]), bounds(count)[1], loops_of_values(count))
        self.may_leave = outer
        if trips is not None and isinstance(statement, ast.For) and isinstance(statement.target, ast.Name):
            self.after_trips(frame, {**entry, statement.target.id: trips.ends[0]}, ident, count,
                             {statement.target.id: trips.ends[1]})
        else:
            self.after_trips(frame, entry, ident, count, {})
        return how if how == "return" and bounds(count)[0] > 0 else ""

    def one_trip(self, statement: ast.For | ast.While, frame: Frame, entry: Mapping[str, Any],
                 trips: Trips | None) -> str:
        ident = id(statement)
        for name in entry:
            frame.scope[name] = Between(-INF, INF, frozenset({ident}), (name, ident), 0)
        if isinstance(statement, ast.For):
            self.bind(statement.target, UNKNOWN if trips is None or not isinstance(statement.target, ast.Name) else
                      trips.counter(statement.target.id, ident), frame)
        return self.block(statement.body, frame)

    def after_trips(self, frame: Frame, entry: Mapping[str, Any], ident: int, count: Any, counter: Mapping[str, Any]
                    ) -> None:
        """What the names hold behind all trips, those of an entry and the counter, with what it gains in each."""
        gained = {n: _summed(v.offset) for n in entry if isinstance(v := frame.scope[n], Between)
                  and v.base == (n, ident)} | {**counter}
        for name, value in list(frame.scope.items()):
            if isinstance(value, Array) and isinstance(value.pushed, Between) and value.pushed.base is not None \
                    and value.pushed.base[1] == ident:
                self.stacks.fill(frame, name, value, entry, gained, count)
            elif name in gained:
                times = count if name not in counter else operated("Sub", count, 1)
                frame.scope[name] = operated("Add", entry[name], operated("Mult", times, gained[name]))
            elif isinstance(value, Between) and value.base is not None and value.base[1] == ident:
                frame.scope[name] = Between(value.low, value.high, value.loops)
            elif name in entry and bounds(count)[0] < 1:
                frame.scope[name] = joined(entry[name], value)


def _named(value: Any) -> Any:
    """A value that has a name: no operation writes into it."""
    if isinstance(value, tuple):
        return tuple(map(_named, value))
    return replace(value, temporary=False) if isinstance(value, Array) and value.temporary else value


def _is_rebound(value: Any, before: Any) -> bool:
    """Whether a name has another array than before, other than since it grew."""
    return isinstance(value, Array) and value is not before and value.pushed is None


def _list_of(call: ast.Call) -> str:
    """The list to which a call appends."""
    method = call.func
    if isinstance(method, ast.Attribute) and method.attr == "append" and isinstance(method.value, ast.Name):
        return method.value.id
    return ""


def _summed(value: Any) -> Any:
    """A number of which one is added for each trip: the largest sum is less than so many times the largest."""
    return replace(value, reached=False) if isinstance(value, Between) else value


def _later(first: Any, second: Any) -> Any:
    """The larger of two numbers of rows."""
    if first is None or second is None:
        return second if first is None else first
    if isinstance(first, Between) and isinstance(second, Between) and first.base == second.base:
        return first if bounds(first.offset)[1] >= bounds(second.offset)[1] else second
    return first if isinstance(first, Between) or not isinstance(second, Between) and first >= second else second


@lru_cache(1024)
def _stored(loop: ast.For | ast.While) -> tuple[str, ...]:
    """The names that a loop binds."""
    inside = [n for s in loop.body for n in ast.walk(s)]
    stored = [n.id for n in inside if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
    lists = [count_of_entries(name) for n in inside if isinstance(n, ast.Call) and (name := _list_of(n))]
    return tuple(dict.fromkeys([*stored, *lists]))


@lru_cache(1024)
def _length(loop: ast.For | ast.While) -> int:
    """The number of statements in a loop."""
    return sum(isinstance(n, ast.stmt) for n in ast.walk(loop)) - 1
