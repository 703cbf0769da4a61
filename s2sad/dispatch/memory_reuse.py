"""The stacks and work arrays of compiled derivatives, and the copies that calls make, kept between calls: fresh memory
costs as much as the arithmetic.

Each thread has its own, and a call takes them for as long as it runs: one that begins inside of another, from a
function of the user's that compiled code calls back, gets fresh ones. What is kept of all derivatives and threads takes
at most $S2SAD_TAPE_SIZE ("500M", "2G"; default 1G): what was not used for the longest time goes, and a tape that is
larger by itself is not kept at all.
"""
from __future__ import annotations

import itertools
import math
import threading
import weakref
from collections.abc import Callable, Mapping
from types import FunctionType
from typing import Any

import numpy as np

from s2sad.run.eviction import byte_limit

_SIZE = 1 << 30
_LARGE = 1 << 16     # bytes; less is had at once
_LINE = 64           # bytes of a line of the processor's cache
_CLOCK = itertools.count()
_LOCK = threading.Lock()


class KeptArrays:
    """What one derivative keeps in one thread, by the places where it is used, None while a call runs; `used` orders by
    the last call."""

    def __init__(self, owner: weakref.ref[FunctionType] | None):
        self.owner, self.used, self.size = owner, 0, 0
        self.arrays: dict[Any, np.ndarray] | None = None
        with _LOCK:
            _KEPT.add(self)

    def take(self) -> dict[Any, np.ndarray]:
        """What a call takes for as long as it runs."""
        taken, self.arrays = self.arrays, None
        return {} if taken is None else taken

    def put(self, arrays: dict[Any, np.ndarray]) -> None:
        """Keeps these; if they have become larger, what is too much goes."""
        size, before = sum([a.nbytes for a in arrays.values()]), self.size
        self.arrays, self.size, self.used = arrays, size, next(_CLOCK)
        if size > before:
            _evict()

    def drop(self) -> None:
        """Keeps nothing any more."""
        self.arrays, self.size = None, 0


class InThreads:
    """What one derivative keeps in each thread."""

    def __init__(self, owner: FunctionType | None = None):
        self._owner = None if owner is None else weakref.ref(owner)
        self._threads = threading.local()

    def kept(self) -> KeptArrays:
        """What this thread keeps."""
        found = getattr(self._threads, "kept", None)
        if found is None:
            found = self._threads.kept = KeptArrays(self._owner)
        return found


_KEPT: weakref.WeakSet[KeptArrays] = weakref.WeakSet()


def _evict() -> None:
    """Drops what was not used for the longest time until the rest is small enough."""
    limit = byte_limit("S2SAD_TAPE_SIZE", _SIZE)
    with _LOCK:
        left = sum(kept.size for kept in _KEPT)
        for kept in sorted(_KEPT, key=lambda k: k.used):
            if left <= limit:
                return
            left -= kept.size
            kept.drop()


def clear_kept(owner: FunctionType | None = None) -> int:
    """Drops what the derivatives of a function keep, or of all, in all threads; the bytes that it took."""
    with _LOCK:
        found = [k for k in _KEPT if owner is None or (k.owner is not None and k.owner() is owner)]
        size = sum(k.size for k in found)
        for kept in found:
            kept.drop()
        return size


def memory_at_first(facts: Mapping[str, Any]) -> tuple[np.ndarray, ...]:
    """The stacks of a derivative, and the arena behind them where it has one, before its first call: empty ones."""
    stacks = tuple(np.empty((0,) * rank, dtype) for _, dtype, rank in facts.get("stacks", ()))
    return (*stacks, np.empty(0)) if facts["arena"] else stacks


class MemoryReuse(InThreads):
    """A compiled derivative with the stacks that it left behind at the last call of each thread, and an arena as large
    as that call had use for."""

    def __init__(self, function: Callable[..., Any], first: tuple[np.ndarray, ...], arena: bool,
                 owner: FunctionType | None = None):
        super().__init__(owner)
        self.function, self.first, self.count = function, first, len(first)
        self._arena = self.count - 1 if arena else None

    def __call__(self, *arguments: Any) -> tuple[Any, ...] | None:
        kept = self.kept()
        given = kept.take() or dict(enumerate(self.first))
        try:
            returned = self.function(*arguments, *given.values())
        except BaseException:
            kept.drop()
            raise
        left = dict(enumerate(returned[-self.count:]))
        if self._arena is not None:
            left[self._arena] = _arena_for(left[self._arena], given[self._arena])
        kept.put(left)
        return returned[:-self.count] or None       # as a derivative that keeps nothing

    @property
    def stack_bytes(self) -> int:
        """The bytes of the stacks that the last call of this thread left behind."""
        kept = self.kept()
        arena = 0 if self._arena is None or not kept.arrays else kept.arrays[self._arena].nbytes
        return kept.size - arena


def _arena_for(wanted: int, had: np.ndarray) -> np.ndarray:
    """An arena for so many numbers: the same one, or a larger one, which takes no memory until it is used."""
    large = _LARGE <= wanted * had.itemsize <= byte_limit("S2SAD_TAPE_SIZE", _SIZE)
    return aligned_empty((wanted,), had.dtype) if large and wanted > had.size else had


def aligned_empty(shape: tuple[int, ...], dtype: np.dtype[Any]) -> np.ndarray:
    """An array of unspecified content that begins where a line of the cache does: what NumPy allocates begins at any
    multiple of 16 bytes, where vectors lie across two lines.

    >>> aligned_empty((3, 4), np.dtype(float)).ctypes.data % 64
    0
    """
    size = math.prod(shape) * dtype.itemsize
    memory = np.empty(size + _LINE, np.uint8)
    first = -memory.ctypes.data % _LINE
    return memory[first:first + size].view(dtype).reshape(shape)


class CallCopies:
    """The copies that one call makes of arguments and seeds, in the memory of those of the last call of its thread."""

    def __init__(self, threads: InThreads):
        self._threads = threads
        self._arrays: dict[Any, np.ndarray] | None = None

    def of(self, place: Any, array: np.ndarray) -> np.ndarray:
        """A copy that nobody has when the call has ended, in C order."""
        found = self.memory(place, array.shape, array.dtype)
        found[...] = array
        return found

    def memory(self, place: Any, shape: tuple[int, ...], dtype: np.dtype[Any]) -> np.ndarray:
        """An array that nobody has when the call has ended, whatever it holds."""
        if math.prod(shape) * dtype.itemsize < _LARGE:
            return np.empty(shape, dtype)
        if self._arrays is None:
            self._arrays = self._threads.kept().take()
        found = self._arrays.get(place)
        if found is None or found.shape != shape or found.dtype != dtype:
            found = self._arrays[place] = aligned_empty(shape, dtype)
        return found

    def end(self) -> None:
        """Keeps their memory for the next call."""
        if self._arrays is not None:
            self._threads.kept().put(self._arrays)
