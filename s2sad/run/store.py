"""What processes hand on to later ones: bytes under a key, on disk.

An entry is a file named by its key's digest, which begins with a checksum of key and content; it is written beside and
renamed. Whatever goes wrong is a miss: a full disk, a file that is damaged, cut off, unreadable, somebody else's or no
file at all. Nothing here raises OSError, and nothing waits.

The checksum is against damage. Against other users, who could write a checksum as well, is `permissions`: where they
can write into the folder it is left alone, and a folder of this process stands in for it.
"""
from __future__ import annotations

import atexit
import hashlib
import logging
import os
import shutil
import sys
import tempfile
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

from s2sad.run.eviction import Account
from s2sad.run.permissions import exposure, is_private

FOLDER = "v2"       # what the entries look like; another form is another folder
_MAGIC = b"s2sad entry 2\n"
_LARGEST = 1 << 28
_DAY = 86_400.0
_ACCOUNT = Account()
_LOG = logging.getLogger("s2sad")


def location() -> Path:
    """The cache of this user: $S2SAD_CACHE_DIR, else the platform's place for caches.

    Raises RuntimeError where the user has no home directory.
    """
    chosen = os.environ.get("S2SAD_CACHE_DIR")
    if chosen:
        return Path(os.path.abspath(os.path.expanduser(chosen)))
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "s2sad" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "s2sad"
    xdg = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(xdg) if os.path.isabs(xdg) else Path.home() / ".cache") / "s2sad"


def folder() -> Path | None:
    """The folder of entries, made if need be: in `location`, or in a temporary folder of this process if that cannot be
    made or others can write there; None if that fails, too."""
    for place in (location, _temporary):
        try:
            found = place() / FOLDER
            _make(found)
            reason = exposure(str(found))
        except (OSError, RuntimeError, ValueError):
            continue
        if reason is None:
            return found
        _say(str(found.parent), reason)
    return None


def get(key: str, kind: str = "data") -> bytes | None:
    """The bytes that were put under a key, None if there are none that are certainly these."""
    place = folder()
    found = None if place is None else read(place / _name(key, kind))
    start = len(_MAGIC) + hashlib.sha256().digest_size
    if found is None or found[:start] != _MAGIC + _checksum(key, kind, found[start:]):
        return None
    return found[start:]


def put(key: str, data: bytes, kind: str = "data") -> bool:
    """Puts bytes under a key, in place of what is there; whether that succeeded. `kind` is a word that says what they
    are: keys of different kinds are different."""
    place = folder()
    return place is not None and write(place / _name(key, kind), _MAGIC + _checksum(key, kind, data) + data)


def keep(filename: str, text: str) -> Path | None:
    """The path of a file that holds exactly `text`, for people and debuggers to read; None if there can be none."""
    place, content = folder(), text.encode()
    if place is None:
        return None
    path = place / filename
    return path if read(path) == content or write(path, content) else None


def read(path: Path) -> bytes | None:
    """The content of a file that only this user can write, None for all else. It counts as used."""
    try:
        if not is_private(os.lstat(path)):
            return None             # a device may do something when it is opened, and a pipe waits
        flags = (getattr(os, name, 0) for name in ("O_BINARY", "O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC"))
        with os.fdopen(os.open(path, os.O_RDONLY | sum(flags)), "rb") as file:
            found = os.fstat(file.fileno())
            if not is_private(found) or found.st_size > _LARGEST:
                return None
            content = file.read(_LARGEST + 1)
        if abs(time.time() - found.st_mtime) > _DAY:
            with suppress(OSError):
                os.utime(path)
        return content
    except (OSError, ValueError, MemoryError):
        return None


def write(path: Path, content: bytes) -> bool:
    """Whether a file could be written, beside and renamed, so that it is never there by half."""
    if len(content) > _LARGEST:
        return False
    beside = None
    try:
        handle, beside = tempfile.mkstemp(suffix=".part", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(beside, path)
        beside = None
        _ACCOUNT.wrote(path.parent.parent, len(content))
    except (OSError, ValueError):
        return False
    finally:
        if beside is not None:
            with suppress(OSError):
                os.unlink(beside)
    return True


def _name(key: str, kind: str) -> str:
    return f"{hashlib.sha256(key.encode()).hexdigest()}.{kind}"


def _checksum(key: str, kind: str, data: bytes) -> bytes:
    return hashlib.sha256(f"{kind}\0{key}\0".encode() + data).digest()


def _make(path: Path) -> None:
    """Makes a folder and those above it, for this user only, whatever the umask."""
    if not path.exists():
        _make(path.parent)
        with suppress(FileExistsError):
            os.mkdir(path, 0o700)


@cache
def _temporary() -> Path:
    made, owner = tempfile.mkdtemp(prefix="s2sad-"), os.getpid()

    def remove() -> None:
        if os.getpid() == owner:    # not at the end of a process that was forked
            shutil.rmtree(made, ignore_errors=True)
    atexit.register(remove)
    return Path(made)


@cache
def _say(place: str, reason: str) -> None:
    """Says once that a folder is not used."""
    _LOG.warning("s2sad: the cache %s is not used: %s, and what it holds is executed. A temporary folder of this "
                 "process is used; set S2SAD_CACHE_DIR to a folder of your own, or correct owner and mode.",
                 place, reason)
