"""How large and how old the store may grow: least recently used entries go first, those of older versions with them."""
from __future__ import annotations

import logging
import os
import re
import stat
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_SIZE, _DAYS = 1 << 30, 90.0
_UNITS = {"": 1, "K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}
_HOUR, _DAY = 3600.0, 86_400.0
_LOG = logging.getLogger("s2sad")

# names that no other program gives its files: the folder may hold other things
_FOLDERS = re.compile(r"v\d+(-(plain|numba-[0-9a-f]{12}(-bounds)?))?|__pycache__")
_FILES = re.compile(r"[0-9a-f]{64}\.[a-z]+|.*_[0-9a-f]{20}\.py|.*_[0-9a-f]{20}\..*\.nb[ic]|.*\.part")


@dataclass(frozen=True)
class Entry:
    """A file of the store: when it was used last, and its size."""
    used: float
    size: int
    path: Path

    @property
    def kind(self) -> str:
        return self.path.suffix[1:]


def limits() -> tuple[int, float]:
    """Bytes and days: $S2SAD_CACHE_SIZE ("500M", "2G"; default 1G) and $S2SAD_CACHE_DAYS (default 90)."""
    return byte_limit("S2SAD_CACHE_SIZE", _SIZE), _setting("S2SAD_CACHE_DAYS", r"(\d+(?:\.\d+)?)()", _DAYS)


def byte_limit(variable: str, default: int) -> int:
    """The bytes that an environment variable allows, as "500M" or "2G"."""
    return int(_setting(variable, r"(\d+(?:\.\d+)?)\s*([KMGT]?)i?B?", default))


def entries(location: Path) -> list[Entry]:
    """The files of the store, of all versions, the least recently used first; links are not followed."""
    return sorted(_entries(location), key=lambda e: (e.used, e.path))


def prune(location: Path) -> int:
    """Removes what has not been used for too long, then what is least recently used until the rest is small enough;
    returns the bytes that are left. Raises nothing: what cannot be removed stays."""
    size, days = limits()
    now, found = time.time(), entries(location)
    left = sum(e.size for e in found)
    for entry in found:
        is_old = now - entry.used > (_HOUR if entry.kind == "part" else days * _DAY)
        if (is_old or left > size) and _removed(entry.path):
            left -= entry.size
    _remove_empty(location)
    return left


def clear(location: Path) -> tuple[int, int]:
    """Removes all files of the store; returns how many went, and their bytes."""
    gone = [e for e in entries(location) if _removed(e.path)]
    _remove_empty(location)
    return len(gone), sum(e.size for e in gone)


class Account:
    """The bytes that this process has stored since it last pruned: it prunes at its first entry, then after each tenth
    of the size that is allowed."""

    def __init__(self) -> None:
        self._location: Path | None = None
        self._written = 0

    def wrote(self, location: Path, size: int) -> None:
        self._written += size
        if location != self._location or self._written > limits()[0] // 10:
            self._location, self._written = location, 0
            prune(location)


def _entries(folder: Path, depth: int = 2) -> Iterator[Entry]:
    try:
        items = list(os.scandir(folder))
    except OSError:
        return
    for item in items:
        with suppress(OSError):
            found = item.stat(follow_symlinks=False)
            if stat.S_ISDIR(found.st_mode) and depth and _FOLDERS.fullmatch(item.name):
                yield from _entries(Path(item.path), depth - 1)
            elif stat.S_ISREG(found.st_mode) and depth < 2 and _FILES.fullmatch(item.name):
                yield Entry(found.st_mtime, found.st_size, Path(item.path))


def _removed(path: Path) -> bool:
    try:
        path.unlink()
    except OSError:
        return False
    return True


def _remove_empty(location: Path) -> None:
    """Removes the folders of older versions that hold nothing any more."""
    with suppress(OSError):
        for folder in [f for f in location.iterdir() if _FOLDERS.fullmatch(f.name) and not f.is_symlink()]:
            for empty in (folder / "__pycache__", folder):
                with suppress(OSError):
                    empty.rmdir()


def _setting(variable: str, form: str, default: float) -> float:
    """The number in an environment variable, with its unit."""
    return _number(variable, os.environ.get(variable, "").strip(), form, default)


@cache
def _number(variable: str, text: str, form: str, default: float) -> float:
    found = re.fullmatch(form, text, re.IGNORECASE)
    if found is None:
        if text:
            _LOG.warning("s2sad: %s=%s is not understood", variable, text)
        return default
    return float(found[1]) * _UNITS[found[2].upper()]
