"""interrupts: what a signal's handler raises while Numba compiles is raised again, wherever that was.

Numba and LLVM call back into Python: what is raised there is printed and passed over, or becomes an error of theirs.
"""
from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def interruptible() -> Iterator[None]:
    """What is done inside can be interrupted (Ctrl-C): what the handler raises then comes out of it in any case."""
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler) or threading.current_thread() is not threading.main_thread():
        yield       # signals are the main thread's
        return
    raised: list[BaseException] = []

    def heard(number: int, frame: FrameType | None) -> None:
        try:
            handler(number, frame)
        except BaseException as error:
            raised.append(error)
            raise
    signal.signal(signal.SIGINT, heard)
    try:
        yield
    except Exception:
        if raised:
            raise raised[0] from None
        raise
    finally:
        signal.signal(signal.SIGINT, handler)
    if raised:
        raise raised[0]
