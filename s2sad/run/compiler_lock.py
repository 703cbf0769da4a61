"""The lock under which derivatives are made, whole in a process that was forked.

A fork copies the memory of all threads and the one thread that forks: a lock that another holds would stay locked in
the child for ever, over what that thread left half done. So a fork waits until no derivative is being made, here or
in Numba, and no other begins before it is done.
"""
from __future__ import annotations

import os
import sys
import threading
from typing import Any

COMPILER_LOCK = threading.RLock()
_held: list[Any] = []                   # Numba's lock, if it was loaded when the fork began


def _before_fork() -> None:
    COMPILER_LOCK.acquire()
    numba = sys.modules.get("numba.core.compiler_lock")
    lock = getattr(numba, "global_compiler_lock", None)
    if lock is not None:
        lock.acquire()
    _held.append(lock)


def _after_fork() -> None:
    lock = _held.pop()
    if lock is not None:
        lock.release()
    COMPILER_LOCK.release()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before_fork, after_in_parent=_after_fork, after_in_child=_after_fork)
