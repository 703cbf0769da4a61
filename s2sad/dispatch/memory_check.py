"""A call that would take more memory than there is, is refused before anything is written.

What a call takes is computed once for sizes and numbers of about the same magnitude: those that have as many binary
digits before the point. Where sixteen times as much is there, all of these are let through.
"""
from __future__ import annotations

import os
import shutil
from collections.abc import Collection, Sequence
from math import frexp, inf
from typing import Any

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.program import Generated, Parameter, RecordedArray
from s2sad.run.exceptions import no_room
from s2sad.run.memory import Footprint, byte_text, footprint_of, growing_tapes
from s2sad.run.memory.call_memory import shown
from s2sad.run.memory.machine_memory import most_memory

_FACTOR = 16        # four numbers may be twice as large
_KEPT = 4096
_SNAPSHOTS = 50     # what is proposed


class MemoryCheck:
    """The check of one generated function, of which the arguments in `written` are changed."""

    def __init__(self, generated: Generated, kernel: str, written: Collection[str]):
        self.generated, self.kernel, self.written = generated, kernel, written
        self.parameters: tuple[Parameter, ...] = generated.facts.get("taken", generated.parameters)
        primals = [(k, p) for k, p in enumerate(self.parameters) if p.role == "primal"]
        self.arrays = [k for k, p in primals if p.type.is_array]
        self.integers = [k for k, p in primals if p.type.is_integer]
        self.floats = [k for k, p in primals if p.type.is_number and p.type.is_float]
        self.folders: tuple[str, ...] = generated.facts.get("folders", ())
        self.fits: set[tuple[int, ...]] = set()

    def __call__(self, arguments: Sequence[Any]) -> None:
        """Raises S2sadError where a call with these arguments cannot have its memory."""
        key = (*[arguments[k].size.bit_length() for k in self.arrays],
               *[int(arguments[k]).bit_length() for k in self.integers], *[frexp(arguments[k])[1] for k in self.floats])
        if key not in self.fits:
            self.compare(key, arguments)

    def compare(self, key: tuple[int, ...], arguments: Sequence[Any]) -> None:
        try:
            found, there, room = self.footprint(arguments), most_memory(), _free_bytes(self.folders)
        except Exception:   # what cannot be foreseen runs
            self.fits.add(key)
            return
        if found.peak * _FACTOR < there and found.disk * _FACTOR < room:
            if len(self.fits) >= _KEPT:
                self.fits.clear()
            self.fits.add(key)
        elif found.peak > there and not found.is_bound:
            raise self.refused(found, f"and this process may have {byte_text(int(there))}", arguments)
        elif found.disk > room and not found.is_bound:
            raise no_room(self.kernel, self.folders, f"{found.disk:,} bytes are needed, {room:,} are free")

    def footprint(self, arguments: Sequence[Any]) -> Footprint:
        values = {p.name: a for p, a in zip(self.parameters, arguments) if p.role == "primal"}
        return footprint_of(self.generated, values, self.written)

    def meaning(self, error: MemoryError, arguments: Sequence[Any]) -> BaseException:
        """What to raise where memory could not be had: the error itself, unless it is the tape that is too large."""
        found = self.footprint(arguments)
        tape_is_large = 2 * found.recorded > found.peak or growing_tapes(found)
        return self.refused(found, "which could not be had", arguments) if tape_is_large else error

    def refused(self, found: Footprint, there: str, arguments: Sequence[Any]) -> S2sadError:
        """The error, at the loop that records most."""
        more = "" if found.is_complete else ", and what is known only at run time"
        head = f"the adjoint of '{self.kernel}' takes {byte_text(found.peak)}{more}, {there}"
        largest = max(found.arrays, key=lambda a: _size(found, a), default=None)
        if largest is None or largest.place is None or _size(found, largest) < (False, found.peak // 4):
            return S2sadError(Diagnostic("S410", head))
        unknown, taken = _size(found, largest)
        note = f"{shown(largest.loop)} records {byte_text(taken)}{' a step' if unknown else ''}"
        state = sum(arguments[k].nbytes for k in self.arrays)
        count = max(1, min(_SNAPSHOTS, int(most_memory() // max(1, 2 * state))))
        keep = "keep fewer snapshots, or some on disk" if largest.kind == "snapshots" else (
            f'checkpoint={{"{largest.loop}": {count}}} keeps snapshots in place of the tape')
        return S2sadError(Diagnostic("S410", head, largest.place.span(), note, keep))


def _free_bytes(folders: Sequence[str]) -> float:
    """The room that there is in folders, each device once; one that is not there is for others to refuse."""
    there = {os.stat(f).st_dev: shutil.disk_usage(f).free for f in folders if os.path.isdir(f)}
    return sum(there.values()) if there else inf


def _size(found: Footprint, array: RecordedArray) -> tuple[bool, int]:
    """Whether an array grows without a bound that is known, and its bytes, those of a step if so."""
    stack = found.stack(array.derivative, array.name)
    if stack is None or array.place is None:
        return False, 0
    return stack.unknown, stack.each if stack.unknown else stack.bytes
