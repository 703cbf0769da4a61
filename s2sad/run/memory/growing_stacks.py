"""Stacks of a tape as they are filled: those that are allocated in their size, and those that grow by doubling.

A push in a loop that stands for all of its trips is known relatively to the beginning of a trip; how far the stack goes
is known behind the loop, from the number of trips and from what each of them adds. Of a stack that grows the rows count
that are written, as no others are memory of the process: those of a copy when it is made are the old ones, beside which
the old stack is still there.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from s2sad.run.memory.abstract_arrays import Array, KeptList, Meter, allocated
from s2sad.run.memory.interval_arithmetic import INF, UNKNOWN, Between, bounds, joined, loops_of_values, operated


def count_of_entries(name: str) -> str:
    """The name under which a scope has the length of a list."""
    return f"{name} length"


@dataclass
class Stack:
    """What one stack takes at most: its bytes, those of a push or of a step of the loop that fills it if the number of
    these is not known (`unknown`)."""
    bytes: int = 0
    each: int = 0
    unknown: bool = False


@dataclass
class Frame:
    """A call: the function, what its names are bound to, and what it returns."""
    function: str
    scope: dict[str, Any]
    returned: Any = None


class Stacks:
    """The arrays that hold a tape or snapshots; `kinds` says which, by function and name."""

    def __init__(self, meter: Meter, kinds: Mapping[tuple[str, str], str]):
        self.meter, self.kinds = meter, dict(kinds)
        self.found: dict[tuple[str, str], Stack] = {}

    def differs(self, loops: frozenset[int]) -> None:
        """Notes that memory depends on what only trips of these loops tell, or data."""
        self.meter.loops |= loops
        self.meter.bounded = self.meter.bounded or not loops

    def grow(self, frame: Frame, name: str, place: Any) -> None:
        """A push onto a stack; where only trips tell how far it goes this is said behind the loop."""
        stack = frame.scope.get(name)
        if isinstance(stack, Array):
            rows = operated("Add", place, 1)
            if isinstance(rows, Between) and rows.base is not None:
                frame.scope[name] = replace(stack, pushed=rows, push=max(stack.push, _push(stack.pushed, rows)))
            else:
                self.reach(frame, name, stack, rows, bounds(rows)[1])

    def append(self, frame: Frame, name: str, entry: Any) -> None:
        """Something that a half of an adjoint keeps goes on a list, and counts there."""
        there = frame.scope.get(name)
        if not isinstance(there, KeptList):
            return
        parts = entry if isinstance(entry, tuple) else (entry,)
        buffers = [e.buffer for e in parts if isinstance(e, Array) and e.buffer is not None]
        kind = buffers[0].kind if buffers else "tape"
        bytes_each = max(there.dtype.itemsize, sum(b.give_up() for b in buffers))
        self.meter.unknown = self.meter.unknown or not isinstance(entry, (Array, tuple))
        self.meter.events += 1
        place = frame.scope.get(count_of_entries(name), UNKNOWN)
        frame.scope[count_of_entries(name)] = operated("Add", place, 1)
        made = replace(there, dtype=np.dtype(f"V{bytes_each}"), entry=entry)
        self.kinds.setdefault((frame.function, name), kind)
        frame.scope[name] = made
        self.grow(frame, name, place)

    def fill(self, frame: Frame, name: str, stack: Array, entry: Mapping[str, Any], gained: Mapping[str, Any],
             count: Any) -> None:
        """All pushes of a loop's trips onto a stack."""
        counter = stack.pushed.base[0]
        step = gained.get(counter, UNKNOWN)
        if bounds(count)[1] == INF:
            self.fills_unknown(frame, name, stack, step)
            return
        more = operated("Mult", operated("Sub", count, 1), step) if bounds(step)[1] > 0 else 0
        rows = operated("Add", entry.get(counter, UNKNOWN), operated("Add", stack.pushed.offset, more))
        if isinstance(rows, Between) and rows.base is not None:
            frame.scope[name] = replace(stack, pushed=rows)
        else:
            self.reach(frame, name, stack, rows, stack.push)

    def fills_unknown(self, frame: Frame, name: str, stack: Array, step: Any) -> None:
        """A stack onto which a loop pushes whose number of trips is not known."""
        found = self.noted(frame, name, stack)
        found.unknown = self.meter.unknown = True
        pushes = bounds(step)[1]
        row = self.meter.count_of(stack.shape[1:]) * stack.dtype.itemsize
        found.each = max(found.each, row * (1 if pushes == INF else max(1, int(pushes))))
        frame.scope[name] = replace(stack, pushed=UNKNOWN)

    def reach(self, frame: Frame, name: str, stack: Array, rows: Any, push: float) -> None:
        """A stack has so many rows, by pushes of `push`: it has been doubled as often as that takes."""
        low, high = bounds(rows)
        if high == INF:
            self.differs(loops_of_values(rows))
            self.fills_unknown(frame, name, stack, UNKNOWN)
            return
        if low < high and not rows.reached:
            self.differs(loops_of_values(rows))
        there, row = int(bounds(stack.shape[0])[1]), self.meter.count_of(stack.shape[1:]) * stack.dtype.itemsize
        held = 0 if stack.buffer is None else stack.buffer.bytes
        if isinstance(stack, KeptList):
            capacity, most = max(int(high), there), 0
        else:
            capacity, most = _grown(there, held // row if row else 0, int(high), int(push))
        if row * high <= held and capacity == there:
            frame.scope[name] = replace(stack, pushed=rows)
            return
        kind = self.kinds.get((frame.function, name), "work")
        self.meter.note(kind, row * most - held)
        with self.meter.making(kind, int(high), instead=stack.buffer):
            made = allocated(self.meter, (capacity, *stack.shape[1:]), stack.dtype)
        assert made.buffer is not None
        made.buffer.values = None if stack.buffer is None else stack.buffer.values
        frame.scope[name] = replace(stack, shape=made.shape, buffer=made.buffer, pushed=rows)
        self.noted(frame, name, made)

    def holds(self, frame: Frame, name: str, value: Any) -> None:
        """A value is stored in a stack of integers."""
        stack = frame.scope.get(name)
        if not isinstance(stack, Array) or stack.buffer is None:
            return
        if (frame.function, name) in self.kinds and stack.dtype.kind == "i":
            there = stack.buffer.values
            self.meter.events += 1
            stack.buffer.values = value if there is None else replace(joined(there, value), base=None, reached=True)

    def state(self) -> dict[tuple[str, str], Stack]:
        """What has been found until now, to be `found` again."""
        return {pair: replace(stack) for pair, stack in self.found.items()}

    def noted(self, frame: Frame, name: str, value: Array) -> Stack:
        """What is known of a stack, with what it takes now."""
        found = self.found.setdefault((frame.function, name), Stack())
        found.bytes = max(found.bytes, 0 if value.buffer is None else value.buffer.bytes)
        return found


def _push(before: Any, rows: Between) -> int:
    """How many rows a push adds to those of the one before in the same trip."""
    same = isinstance(before, Between) and before.base == rows.base
    added = bounds(operated("Sub", rows.offset, before.offset) if same else rows.offset)[1]
    return int(added) if 0 < added < INF else 1


def _grown(capacity: int, written: int, rows: int, push: int) -> tuple[int, int]:
    """The rows for which `runtime.grow` has made room when a stack has so many, which have come behind those that are
    written in pushes of `push`, and the most that were there at once in a stack and its copy.

    >>> _grown(64, 0, 100, 1), _grown(64, 0, 1000, 500), _grown(64, 50, 1000, 1000), _grown(64, 0, 50, 1)
    ((128, 128), (1000, 1000), (1000, 114), (64, 0))
    """
    most = 0
    while capacity < rows:
        needed = rows - (rows - capacity - 1) // push * push    # the first push for which there is no room
        most = capacity + min(capacity, max(written, needed - push))
        capacity = max(2 * capacity, needed)
    return capacity, most
