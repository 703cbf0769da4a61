"""Recursion as deep as a kernel's text: a sum of a thousand terms is a tree a thousand levels deep.

The passes follow the tree by recursion. Where Python's limit is met, the work begins anew in a thread with a large
stack and a higher limit; long programs begin there, since what meets the limit last is done twice. Kernels of the usual
kind never see that thread. One such thread runs at a time.
"""
from __future__ import annotations

import contextvars
import ctypes
import functools
import sys
import threading
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

_STACK = 512 * 2 ** 20      # bytes of address space, of which what is used is taken
_LIMIT = 100_000            # calls
_LOCK = threading.Lock()
_here = threading.local()


def deep_stack(function: Callable[P, R]) -> Callable[P, R]:
    """The function, called anew on a larger stack where its recursion is too deep for the one at hand, and called there
    at once where an argument `is_long`, as a program may be.

    Of such functions that call each other it is the outermost; it must not have changed anything where it raises
    RecursionError.

    >>> @deep_stack
    ... def nested(n):
    ...     return n and 1 + nested(n - 1)
    >>> nested(5000)
    5000
    """
    @functools.wraps(function)
    def called(*args: P.args, **keywords: P.kwargs) -> R:
        if getattr(_here, "inside", False):
            return function(*args, **keywords)
        if not any(getattr(a, "is_long", False) for a in args):
            _here.inside = True
            try:
                return function(*args, **keywords)
            except RecursionError:
                pass
            finally:
                _here.inside = False
        with _LOCK:
            return _in_thread(functools.partial(function, *args, **keywords))
    return called


def on_deep_stack() -> bool:
    """Whether this thread is the one with the large stack."""
    return getattr(_here, "deep", False)


def _in_thread(call: Callable[[], R]) -> R:
    """What a call gives, or raises, in a thread with a large stack; an interrupt ends that thread."""
    found: dict[str, Any] = {}
    context = contextvars.copy_context()

    def run() -> None:
        _here.deep = _here.inside = True
        try:
            found["value"] = context.run(call)
        except BaseException as error:
            found["error"] = error
    size, limit = threading.stack_size(_STACK), sys.getrecursionlimit()
    try:
        thread = threading.Thread(target=run, name="s2sad, deep recursion")
        sys.setrecursionlimit(max(limit, _LIMIT))
        thread.start()
        threading.stack_size(size)
        _joined(thread)
    finally:
        threading.stack_size(size)
        sys.setrecursionlimit(limit)
    if "error" in found:
        raise found["error"]
    return found["value"]


def _joined(thread: threading.Thread) -> None:
    while thread.is_alive():
        try:
            thread.join()
        except KeyboardInterrupt:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0),
                                                       ctypes.py_object(KeyboardInterrupt))
