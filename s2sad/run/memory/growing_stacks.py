"""Stacks of a tape as they are filled: those that are allocated in their size, and those that grow by doubling.

A push in a loop that stands for all of its trips is known relatively to the beginning of a trip; how far the stack goes
is known behind the loop, from the number of trips and from what each of them adds.
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
                frame.scope[name] = replace(stack, pushed=rows)
            else:
                self.reach(frame, name, stack, rows)

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
            self.reach(frame, name, stack, rows)

    def fills_unknown(self, frame: Frame, name: str, stack: Array, step: Any) -> None:
        """A stack onto which a loop pushes whose number of trips is not known."""
        found = self.noted(frame, name, stack)
        found.unknown = self.meter.unknown = True
        pushes = bounds(step)[1]
        row = self.meter.count_of(stack.shape[1:]) * stack.dtype.itemsize
        found.each = max(found.each, row * (1 if pushes == INF else max(1, int(pushes))))
        frame.scope[name] = replace(stack, pushed=UNKNOWN)

    def reach(self, frame: Frame, name: str, stack: Array, rows: Any) -> None:
        """A stack has room for so many rows: it has been doubled as often as that takes."""
        low, high = bounds(rows)
        if high == INF:
            self.differs(loops_of_values(rows))
            self.fills_unknown(frame, name, stack, UNKNOWN)
            return
        if low < high and not rows.reached:
            self.differs(loops_of_values(rows))
        there = capacity = int(bounds(stack.shape[0])[1])
        if isinstance(stack, KeptList):
            there, capacity = 0, max(int(high), capacity)
        while capacity < high:
            there, capacity = capacity, max(2 * capacity, 1)
        if capacity == int(bounds(stack.shape[0])[1]):
            frame.scope[name] = replace(stack, pushed=rows)
            return
        self.meter.kind = kind = self.kinds.get((frame.function, name), "work")
        made = allocated(self.meter, (capacity, *stack.shape[1:]), stack.dtype)
        self.meter.kind = "work"
        assert made.buffer is not None
        made.buffer.values = None if stack.buffer is None else stack.buffer.values
        old = made.buffer.bytes * there // max(capacity, 1)
        self.meter.note(kind, old - (0 if stack.buffer is None else stack.buffer.bytes))
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
