"""overlap: whether arrays may be passed to a generated function: shapes, and memory that must lie apart.

A `Check` is made once for a signature. Under Numba a signature that is called often has one small compiled function,
which sees bounding intervals only; where they meet, at the first calls, and under NumPy, the exact test runs in Python.
Nothing has been written when it raises.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.run.compiled import compiled, prepare
from s2sad.run.module_loader import keep_loaded

_MAX_WORK = 100_000
_MAX_CELLS = 10_000_000
_OFTEN = 16     # calls from which on compiling the check is worth its second


@dataclass(frozen=True)
class Slot:
    """One array argument: its name, its role ("primal", "shadow" or "seed"), the name of its primal (its own if it
    is one), and whether the function may write it."""
    name: str
    role: str
    primal: str
    written: bool


class Check:
    """`check(arrays)` raises S2sadError unless they fit, and unless the cells of what is written lie apart; it returns
    the positions of the shadows that share memory with an earlier one because their primals, which are only read, do
    (they need a private sum)."""

    def __init__(self, slots: Sequence[Slot], engine: str):
        self.slots = tuple(slots)
        place = {slot.name: k for k, slot in enumerate(slots) if slot.role == "primal"}
        self.shapes = [(k, place[s.primal]) for k, s in enumerate(slots) if s.role == "shadow" and s.primal in place]
        self.alone = [k for k, s in enumerate(slots) if s.written]
        self.pairs = [(i, j) for i, j in combinations(range(len(slots)), 2) if _matters(slots[i], slots[j])]
        self.quick: Callable[..., int] | None = None
        self.left = _OFTEN if engine == "numba" and (self.pairs or self.alone) else -1     # calls until it compiles

    def __call__(self, arrays: Sequence[Any]) -> tuple[int, ...]:
        if self.quick is not None and self.quick(*arrays) == 0:
            return ()
        shared = self.exact(arrays)
        if self.left == 0:
            self.quick = keep_loaded(compiled(self._text(), "check", entries=["check"]), self).check
            prepare(self.quick, tuple(arrays), "the argument check")
        self.left -= self.left >= 0
        return shared

    def exact(self, arrays: Sequence[Any]) -> tuple[int, ...]:
        for shadow, primal in self.shapes:
            if arrays[shadow].shape != arrays[primal].shape:
                raise S2sadError(shape_mismatch(self.slots[shadow].name, arrays[shadow].shape,
                                                self.slots[primal].name, arrays[primal].shape))
        for k in self.alone:
            if folded(arrays[k]):
                raise S2sadError(self_overlap(self.slots[k]))
        where = {slot.name: arrays[k] for k, slot in enumerate(self.slots) if slot.role == "primal"}
        shared = []
        for i, j in self.pairs:
            if not overlap(arrays[i], arrays[j]):
                continue
            a, b = self.slots[i], self.slots[j]
            if not _may_share(a, b, where, {s.name for s in self.slots if s.written}):
                raise S2sadError(_overlapping(a, b))
            shared.append(j)
        return tuple(sorted(set(shared)))

    def _text(self) -> str:
        names = [f"a{k}" for k in range(len(self.slots))]
        lines = [_EXTENT, f"def check({', '.join(names)}):"]
        lines += [f"    if a{i}.shape != a{j}.shape:\n        return 1" for i, j in self.shapes]
        lines += [f"    if folded(a{k}):\n        return 3" for k in self.alone]
        lines += [f"    low{k}, high{k} = extent(a{k})" for k in sorted({k for pair in self.pairs for k in pair})]
        lines += [f"    if low{i} < high{j} and low{j} < high{i}:\n        return 2" for i, j in self.pairs]
        return "\n".join([*lines, "    return 0", ""])


_EXTENT = '''"""Are the arrays of one call of the right shapes, and apart in memory? 0 if they are."""
import numpy as np


def folded(a):
    if a.flags.c_contiguous or a.size == 0:
        return False
    for k in range(a.ndim):
        room = a.itemsize
        for j in range(a.ndim):
            if abs(a.strides[j]) < abs(a.strides[k]) or j < k and abs(a.strides[j]) == abs(a.strides[k]):
                room += (a.shape[j] - 1) * abs(a.strides[j])
        if a.shape[k] > 1 and abs(a.strides[k]) < room:
            return True
    return False


def extent(a):
    low = high = np.intp(a.ctypes.data)
    for k in range(a.ndim):
        step = (a.shape[k] - 1) * a.strides[k]
        if a.shape[k] == 0:
            return low, low
        if step < 0:
            low += step
        else:
            high += step
    return low, high + a.itemsize


'''


def overlap(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two arrays have a byte in common; assumed where that is too hard to decide."""
    if not np.may_share_memory(a, b):
        return False
    try:
        return np.shares_memory(a, b, max_work=_MAX_WORK)  # pyright: ignore[reportArgumentType]
    except np.exceptions.TooHardError:
        return True


def folded(array: np.ndarray) -> bool:
    """Whether two cells of an array have a byte in common, through a stride of 0 or one that is too short."""
    if array.flags.forc or array.size == 0:
        return False
    axes = sorted((abs(s), n) for n, s in zip(array.shape, array.strides) if n > 1)
    room = array.itemsize
    for stride, n in axes:
        if stride < room:
            break       # it may be: each axis may still step between the cells of the others
        room += (n - 1) * stride
    else:
        return False
    if axes[0][0] == 0 or array.size > _MAX_CELLS:
        return True
    places = np.zeros(1, np.int64)
    for stride, n in axes:
        places = np.add.outer(places, stride * np.arange(n)).ravel()
    places.sort()
    return bool(np.any(np.diff(places) < array.itemsize))


def self_overlap(slot: Slot) -> Diagnostic:
    """The error for an array that is stored to and overlaps itself."""
    if slot.role == "primal":
        return Diagnostic("S404", f"the argument {_plain(slot)} overlaps itself, and it is written",
                          help="pass a copy of it")
    return Diagnostic("S403", f"the shadow '{slot.name}' overlaps itself",
                      help=f"make one with s2sad.make_zero({slot.primal})")


def shape_mismatch(shadow: str, shape: tuple[int, ...], primal: str, wanted: tuple[int, ...]) -> Diagnostic:
    return Diagnostic("S403", f"the shadow '{shadow}' has shape {shape}, its primal '{primal}' has {wanted}",
                      help=f"make one with s2sad.make_zero({primal})")


def _matters(a: Slot, b: Slot) -> bool:
    return "shadow" in (a.role, b.role) or a.written or b.written


def _may_share(a: Slot, b: Slot, primals: dict[str, Any], written: set[str]) -> bool:
    """Shadows may share memory where their primals, only read, do."""
    if a.role != "shadow" or b.role != "shadow" or a.primal in written or b.primal in written:
        return False
    return a.primal in primals and b.primal in primals and overlap(primals[a.primal], primals[b.primal])


def _overlapping(a: Slot, b: Slot) -> Diagnostic:
    if a.role == b.role == "primal":
        writer = _plain(a if a.written else b)
        return Diagnostic("S404", f"the arguments {_plain(a)} and {_plain(b)} share memory, and {writer} is written",
                          help="pass a copy of one of them")
    kind = {"shadow": "shadow", "seed": "seed", "primal": "argument"}
    return Diagnostic("S404", f"the {kind[a.role]} {_plain(a)} and the {kind[b.role]} {_plain(b)} share memory",
                      help="give each shadow memory of its own: s2sad.make_zero(x)")


def _plain(slot: Slot) -> str:
    """The name in quotes; an array that the kernel reads from its module is called as it is there."""
    return f"'{slot.name.rpartition('.')[2]}'"
