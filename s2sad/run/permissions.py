"""Who else can put files into a folder: owner and mode of every folder on the way to it.

What the cache holds is executed. A checksum finds damage, but whoever can write an entry can write its checksum, too.
Nobody can who owns no folder between the root and the entry and may write none of them; in a sticky folder, as /tmp is,
others may make files but not touch or replace those of others.
"""
from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable, Iterator

_ROOT = 0
_LINKS = 40         # more on one way are a circle
_OTHERS = stat.S_IWGRP | stat.S_IWOTH
_Lstat = Callable[[str], os.stat_result]


def exposure(folder: str, uid: int | None = None, lstat: _Lstat = os.lstat,
             readlink: Callable[[str], str] = os.readlink) -> str | None:
    """What lets other users write into `folder`, in words; None if nothing does.

    Each folder from the root on must belong to `uid` (the process's user) or to root, and be writable by no others
    unless it is sticky; `folder` itself must belong to `uid` and be writable by no others, sticky or not. Symbolic
    links are followed one by one, so that the folders that hold them are looked at, too, and must belong to `uid` or
    root themselves. Where files have no such owners (Windows) the user's profile is what protects them.

    Raises OSError if the folder is not there, or is no folder.
    """
    uid = _user() if uid is None else uid
    if uid is None:
        return None
    step, found = "", None
    for step, found in _ancestors(os.path.abspath(folder), lstat, readlink):
        if found.st_uid not in (uid, _ROOT):
            return f"{step} belongs to another user"
        if stat.S_ISLNK(found.st_mode):
            continue
        if not stat.S_ISDIR(found.st_mode):
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), step)
        if found.st_mode & _OTHERS and not found.st_mode & stat.S_ISVTX:
            return f"{step} can be written by other users"
    assert found is not None    # the root is on every way
    if found.st_uid != uid:
        return f"{step} belongs to root"
    return f"{step} can be written by other users" if found.st_mode & _OTHERS else None


def is_private(found: os.stat_result, uid: int | None = None) -> bool:
    """Whether what was found is a plain file that belongs to `uid` (the process's user) and that nobody else can
    write."""
    if not stat.S_ISREG(found.st_mode):
        return False
    uid = _user() if uid is None else uid
    return uid is None or found.st_uid == uid and not found.st_mode & _OTHERS


def _user() -> int | None:
    return os.geteuid() if hasattr(os, "geteuid") else None


def _ancestors(path: str, lstat: _Lstat, readlink: Callable[[str], str]) -> Iterator[tuple[str, os.stat_result]]:
    """The folders from the root to an absolute path, the last one last, and the links that lead there."""
    here, ahead, links = os.sep, _parts(path), 0
    yield here, lstat(here)
    while ahead:
        step = os.path.normpath(os.path.join(here, ahead.pop()))
        found = lstat(step)
        yield step, found
        if not stat.S_ISLNK(found.st_mode):
            here = step
            continue
        links += 1
        if links > _LINKS:
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), path)
        target = readlink(step)
        ahead += _parts(target)
        if os.path.isabs(target):
            here = os.sep
            yield here, lstat(here)


def _parts(path: str) -> list[str]:
    """The names in a path, the first one last."""
    return [part for part in reversed(path.split(os.sep)) if part]
