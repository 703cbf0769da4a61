"""Arrays without content: shapes, types and the memory behind them, counted as Python would hold it.

A `Buffer` counts for as long as something refers to it: what the interpreter binds, rebinds and leaves behind is bound,
rebound and freed here as it is in a run.
"""
from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from s2sad.run.memory.interval_arithmetic import INF, Between, bounds, least, loops_of_values, operated

_ELIDED = 256 * 1024    # bytes from which NumPy writes the result of an operation into an operand that nobody else has


@dataclass
class Meter:
    """The bytes that are held, and the most that were, in all and by what they are for (`kind`); the loops that would
    have to be followed to know them, whether some are bounds, and whether some are not known."""
    live: int = 0
    peak: int = 0
    by_kind: Counter[str] = field(default_factory=Counter)
    peaks: Counter[str] = field(default_factory=Counter)
    loops: set[int] = field(default_factory=set)
    vague: set[int] = field(default_factory=set)        # of what lives for a statement
    bounded: bool = False
    unknown: bool = False
    kind: str = "work"      # of what is allocated now
    rows: int | None = None     # of what is allocated now and is written in its first rows alone
    events: int = 0         # allocations, and whatever else may change what is held

    def add(self, kind: str, count: int) -> None:
        for each in _groups(kind):
            self.by_kind[each] += count
        self.events += 1
        self.live += count if kind != "disk" else 0
        self.note(kind)

    def note(self, kind: str, more: int = 0) -> None:
        """The most that is held, with `more` for a moment."""
        self.peak = max(self.peak, self.live + (more if kind != "disk" else 0))
        for each in _groups(kind):
            self.peaks[each] = max(self.peaks[each], self.by_kind[each] + more)

    def remove(self, kind: str, count: int) -> None:
        self.live -= count if kind != "disk" else 0
        for each in _groups(kind):
            self.by_kind[each] -= count

    @contextmanager
    def making(self, kind: str, rows: int | None = None, instead: Buffer | None = None) -> Iterator[None]:
        """What is allocated now is for this, is written in its first rows alone, and takes the place of another."""
        self.kind, self.rows = kind, rows
        if instead is not None:
            self.remove(instead.kind, instead.bytes)
        yield
        self.kind, self.rows = "work", None
        if instead is not None:
            self.remove(instead.kind, -instead.bytes)

    def state(self) -> tuple[Any, ...]:
        """What `restore` needs; what is held follows from references."""
        return self.peak, self.peaks.copy(), set(self.loops), set(self.vague), self.bounded, self.unknown

    def restore(self, state: tuple[Any, ...]) -> None:
        self.peak, self.peaks, self.loops, self.vague, self.bounded, self.unknown = state

    def count_of(self, shape: tuple[Any, ...], temporary: bool = False) -> int:
        """The number of elements of a shape, the most that it can be; notes where data say how many it is, or nothing
        does before the run."""
        count = 1
        for extent in shape:
            low, high = bounds(extent)
            if isinstance(extent, Between) and not extent.reached:
                self.vague |= extent.loops
            self.bounded = self.bounded or low < high and not temporary and not loops_of_values(extent)
            if math.isinf(high):
                self.loops |= loops_of_values(extent)
                self.unknown = True
                return 0
            count *= max(0, int(high))
        return count


def _groups(kind: str) -> tuple[str, ...]:
    """A kind, and what it is one of."""
    return (kind, "recorded") if kind != "work" else (kind,)


class Buffer:
    """Memory, counted while it is referred to; of a stack of integers `values` is what they may be."""
    __slots__ = ("bytes", "kind", "meter", "values")

    def __init__(self, meter: Meter, count: int):
        self.meter, self.bytes, self.kind, self.values = meter, count, meter.kind, None
        meter.add(meter.kind, count)

    def __del__(self) -> None:
        self.meter.remove(self.kind, self.bytes)

    def give_up(self) -> int:
        """The bytes, which count elsewhere from now on."""
        count, self.bytes = self.bytes, 0
        self.meter.remove(self.kind, count)
        return count

    def tag(self, kind: str) -> None:
        """The memory is for something else than was thought."""
        if kind != self.kind:
            self.meter.remove(self.kind, self.bytes)
            self.kind = kind
            self.meter.add(kind, self.bytes)


@dataclass(frozen=True, eq=False)
class Array:
    """An array: `buffer` is None for memory that is not counted, `content` what is known to lie in it, `temporary` says
    that it is an intermediate result, `pushed` that it is a stack that has grown, `push` by how many rows at once."""
    shape: tuple[Any, ...]
    dtype: np.dtype[Any]
    buffer: Buffer | None = None
    content: Any = None
    temporary: bool = False
    pushed: Any = None
    push: int = 1

    @property
    def size(self) -> Any:
        found: Any = 1
        for extent in self.shape:
            found = operated("Mult", found, extent)
        return found

    def view(self, shape: tuple[Any, ...]) -> Array:
        return replace(self, shape=shape, content=None, temporary=False, pushed=None)


@dataclass(frozen=True, eq=False)
class KeptList(Array):
    """A list of what halves of adjoints keep: its entries are of one make, that of `entry`."""
    entry: Any = None


def allocated(meter: Meter, shape: tuple[Any, ...], dtype: Any, temporary: bool = False) -> Array:
    """A new array."""
    kind = np.dtype(dtype)
    extents = tuple(least([e, 0], largest=True) for e in shape)
    held = extents if meter.rows is None else (least([meter.rows, extents[0]]), *extents[1:])
    return Array(extents, kind, Buffer(meter, meter.count_of(held, temporary) * kind.itemsize), temporary=temporary)


def elementwise(meter: Meter, operands: list[Any], dtype: Any = None) -> Array:
    """The result of an operation on arrays and numbers, in the memory of an operand where NumPy does that."""
    arrays = [a for a in operands if isinstance(a, Array)]
    shape = broadcast([a.shape for a in arrays])
    kind = np.dtype(dtype) if dtype is not None else _promoted(operands)
    for array in arrays:
        if array.temporary and array.dtype == kind and len(array.shape) == len(shape) and array.buffer and \
                array.shape == shape and array.buffer.bytes >= _ELIDED:
            return Array(shape, kind, array.buffer, temporary=True)
    return allocated(meter, shape, kind, temporary=True)


def broadcast(shapes: list[tuple[Any, ...]]) -> tuple[Any, ...]:
    """The shape that arrays of several shapes have together."""
    rank = max(map(len, shapes))
    found = []
    for extents in zip(*((1,) * (rank - len(s)) + s for s in shapes)):
        several = [e for e in extents if e != 1]
        known = [e for e in several if not isinstance(e, Between)]
        found.append(known[0] if known else several[0] if several else 1)
    return tuple(found)


def _promoted(operands: list[Any]) -> np.dtype[Any]:
    """The dtype of a result: Python's numbers follow the arrays."""
    arrays = [a.dtype for a in operands if isinstance(a, Array)]
    found = np.result_type(*arrays)
    numbers = [n for n in operands if not isinstance(n, Array)]
    if found.kind in "biu" and any(isinstance(n, (float, Between)) for n in numbers):
        found = np.result_type(found, np.float64)
    return np.result_type(found, np.complex64) if any(isinstance(n, complex) for n in numbers) else found


def extent_of_slice(start: Any, stop: Any, step: Any, extent: Any) -> Any:
    """The number of elements that a slice takes of an axis; None stands for a bound that is left out."""
    parts = [p for p in (start, stop, step, extent) if p is not None]
    if not any(isinstance(p, Between) for p in parts):
        return len(range(*slice(start, stop, step).indices(extent)))
    high = bounds(extent)[1]
    ends_known = all(p is None or isinstance(p, int) for p in (start, stop))
    if isinstance(extent, Between) and step in (None, 1) and ends_known:
        first = start or 0
        taken = extent if first >= 0 else -first
        if stop is None and first >= 0:
            return least([operated("Sub", extent, first), 0], largest=True)
        if stop is not None and stop < 0 <= first:
            return least([operated("Sub", taken, first - stop), 0], largest=True)
    if stop is not None and step in (None, 1) and bounds(stop)[0] >= 0:
        high = min(high, bounds(stop)[1] - max(0, bounds(start)[0] if start is not None else 0))
    reached = isinstance(stop, Between) and stop.reached and start is None and not isinstance(extent, Between)
    return Between(0, max(0, high) if high < INF else INF, loops_of_values(*parts), reached=reached)
