"""What `checkpoint`, `memory` and `tape_dtype` may be: the loops that keep snapshots, and how many, or a limit for the
memory of a call; what counts where memory costs time; in what floats are recorded.

    {"k": 20, "advance.k": 10, "line 14": Snapshots(5, on_disk="/scratch")}
    "1 GB", "200 MB", 1_000_000_000
"""
from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, get_args

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.interface.schedules import is_schedule, schedule_of
from s2sad.program import Checkpoints, Economy, Recording, Snapshots, TapeDtype

Checkpoint = Mapping[str, Any] | Iterable[tuple[str, Any]] | str | int | Recording | None

ECONOMIES, TAPE_DTYPES = get_args(Economy), get_args(TapeDtype)
_PLAIN = Recording()
_LIMIT = re.compile(r"(\d+(?:\.\d+)?)\s*([kMGT]?)(i?)B", re.IGNORECASE)
_POWERS = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}


def recording_of(checkpoint: Checkpoint, memory: Economy | None = None, tape_dtype: TapeDtype | None = None,
                 carried: Recording = _PLAIN) -> Recording:
    """What is carried, with what `checkpoint`, `memory` and `tape_dtype` say in its place; raises S2sadError (S408).

    >>> recording_of("1.5 GB").limit, recording_of("2 MiB", "least").memory, recording_of({"k": 20}).loops[0][1].count
    (1500000000, 'least', 20)
    """
    if isinstance(checkpoint, Recording):
        carried = checkpoint
    elif checkpoint is not None:
        one = isinstance(checkpoint, str) or not isinstance(checkpoint, Iterable)
        loops, limit = ((), _limit_of(checkpoint)) if one else (_loops_of(checkpoint), 0)
        carried = replace(carried, loops=loops, limit=limit)
    for title, said, known in (("memory", memory, ECONOMIES), ("tape_dtype", tape_dtype, TAPE_DTYPES)):
        if said is not None and said not in known:
            raise S2sadError(Diagnostic("S408", f"{title} is {said!r}", help=f"say {', '.join(map(repr, known))}"))
    return replace(carried, memory=memory or carried.memory, tape_dtype=tape_dtype or carried.tape_dtype)


def _loops_of(chosen: Any) -> Checkpoints:
    """The loops that keep snapshots, by what the user calls them, and how many each keeps."""
    found: tuple[tuple[Any, Any], ...] = tuple(dict(chosen).items())
    return tuple((loop, _snapshots_of(loop, snapshots)) for loop, snapshots in found)


def _limit_of(chosen: Any) -> int:
    """A number of bytes, or one with its unit."""
    if isinstance(chosen, str):
        said = _LIMIT.fullmatch(chosen.strip())
        size = 0 if said is None else int(float(said[1]) * (1024 if said[3] else 1000) ** _POWERS[said[2].upper()])
    else:
        size = int(chosen) if isinstance(chosen, (int, np.integer)) and not isinstance(chosen, bool) else 0
    if size < 1:
        raise _unclear(f"checkpoint is {chosen!r}")
    return size


def _snapshots_of(loop: Any, chosen: Any) -> Snapshots:
    """How many snapshots a loop keeps, and where."""
    snapshots = chosen if isinstance(chosen, Snapshots) else Snapshots(chosen)
    count, folder, schedule = snapshots.count, snapshots.on_disk, snapshots.schedule
    if is_schedule(count):
        schedule = schedule_of(count)
        count = schedule.rows
    if not isinstance(loop, str) or isinstance(count, bool) or not isinstance(count, (int, np.integer)):
        raise _unclear(f"checkpoint holds {loop!r}: {chosen!r}")
    if count < 1:
        raise S2sadError(Diagnostic("S408", f"checkpoint holds {loop!r}: {chosen}, and a loop keeps one "
                                    "snapshot at least", help="more snapshots are fewer steps that run again"))
    if folder is not None and not isinstance(folder, (str, os.PathLike)):
        raise S2sadError(Diagnostic("S408", f"checkpoint holds {loop!r}: {chosen}, which names no folder",
                                    help='give its path: s2sad.Snapshots(20, on_disk="/scratch")'))
    if schedule is not None and schedule.on_disk and folder is None:
        raise S2sadError(Diagnostic("S408", f"the schedule {schedule.title} of {loop!r} uses a disk, and there is no "
                                    "folder", help='give one: s2sad.Snapshots(schedule, on_disk="/scratch")'))
    return Snapshots(int(count), None if folder is None else os.fspath(folder), schedule)


def _unclear(message: str) -> S2sadError:
    return S2sadError(Diagnostic("S408", message, help="name loops and how many snapshots each keeps: "
                                 'checkpoint={"k": 20}, {"advance.k": 20} of a function that is called, '
                                 '{"line 14": 20} by its line; or give the memory that the call may take: '
                                 'checkpoint="1 GB"'))
