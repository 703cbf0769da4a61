"""The stacks of compiled adjoints, kept between calls: fresh memory costs as much as the arithmetic.

Each thread has its own, and a call takes them for as long as it runs: one that begins inside of another, from a
function of the user's that compiled code calls back, gets fresh ones. What is kept of all derivatives and threads takes
at most $S2SAD_TAPE_SIZE ("500M", "2G"; default 1G): what was not used for the longest time goes, and a tape that is
larger by itself is not kept at all.
"""
from __future__ import annotations

import itertools
import threading
import weakref
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from s2sad.run.eviction import byte_limit

_SIZE = 1 << 30
_CLOCK = itertools.count()
_LOCK = threading.Lock()


class KeptStacks:
    """What one derivative keeps in one thread, None while a call runs; `used` orders by the last call."""

    def __init__(self, owner: weakref.ref[FunctionType] | None):
        self.owner, self.used, self.size = owner, 0, 0
        self.stacks: tuple[np.ndarray, ...] | None = None
        with _LOCK:
            _KEPT.add(self)

    def put(self, stacks: tuple[np.ndarray, ...]) -> None:
        """Keeps these; if they have become larger, what is too much goes."""
        size, before = sum([s.nbytes for s in stacks]), self.size
        self.stacks, self.size, self.used = stacks, size, next(_CLOCK)
        if size > before:
            _evict()

    def drop(self) -> None:
        """Keeps nothing any more."""
        self.stacks, self.size = None, 0


_KEPT: weakref.WeakSet[KeptStacks] = weakref.WeakSet()


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


class TapeReuse:
    """A compiled adjoint with the stacks that it left behind at the last call of each thread, used again."""

    def __init__(self, function: Callable[..., Any], first: tuple[np.ndarray, ...], owner: FunctionType | None = None):
        self.function, self.first, self.count = function, first, len(first)
        self._owner = None if owner is None else weakref.ref(owner)
        self._threads = threading.local()

    def __call__(self, *arguments: Any) -> tuple[Any, ...]:
        kept = self.kept()
        stacks, kept.stacks = kept.stacks, None
        try:
            returned = self.function(*arguments, *(self.first if stacks is None else stacks))
        except BaseException:
            kept.drop()
            raise
        kept.put(returned[-self.count:])
        return returned[:-self.count]

    def kept(self) -> KeptStacks:
        """What this thread keeps."""
        found = getattr(self._threads, "kept", None)
        if found is None:
            found = self._threads.kept = KeptStacks(self._owner)
        return found

    @property
    def stack_bytes(self) -> int:
        """The bytes of the stacks that the last call of this thread left behind."""
        return self.kept().size
