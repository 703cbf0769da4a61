"""What takes more than two seconds says so on stderr: a derivative that is made, machine code that is compiled.

`S2SAD_VERBOSE=0` keeps silent, `S2SAD_VERBOSE=1` reports everything, with its seconds. The logger "s2sad" gets the
same, `info` of what is done and `debug` of each function.
"""
from __future__ import annotations

import logging
import os
import sys
import threading
import time
from typing import Any

LOGGER = logging.getLogger("s2sad")
_PATIENCE, _TERMINAL, _FILE = 2.0, 0.5, 30.0       # seconds until something is said, and between what is said then


class Working:
    """Around what may take long: `with Working("compiling 'f'", of=14) as work: work.step("f_adjoint")`."""

    def __init__(self, what: str, of: int = 0):
        self.what, self.of, self.done, self.name = what, of, 0, ""
        self.said, self.ended, self.begun = False, threading.Event(), 0.0

    def __enter__(self) -> Working:
        self.begun = time.monotonic()
        if _verbosity() != "0":
            threading.Thread(target=self._tell, daemon=True).start()
        return self

    def step(self, name: str) -> None:
        """The next of several parts begins."""
        self.done, self.name = self.done + 1, name
        LOGGER.debug("%s", self)

    def __exit__(self, *error: Any) -> None:
        self.ended.set()
        seconds = time.monotonic() - self.begun
        LOGGER.info("%s: %.2f s", self.what, seconds)
        if self.said or _verbosity() not in ("", "0"):
            _say(f"s2sad: {self.what}: {seconds:.1f} s", "\n")

    def __str__(self) -> str:
        part = f" ({min(self.done, self.of)} of {self.of}: {self.name})" if self.of > 1 and self.done else ""
        return f"{self.what}{part}"

    def _tell(self) -> None:
        terminal = getattr(sys.stderr, "isatty", bool)()
        pause = _PATIENCE
        while not self.ended.wait(pause):
            self.said, pause = True, _TERMINAL if terminal else _FILE
            seconds = f" {time.monotonic() - self.begun:.0f} s" if terminal else ""
            _say(f"s2sad: {self} ...{seconds}", "" if terminal else "\n")


def _verbosity() -> str:
    return os.environ.get("S2SAD_VERBOSE", "")


def _say(text: str, end: str) -> None:
    if sys.stderr is not None:
        back = "\r\033[K" if getattr(sys.stderr, "isatty", bool)() else ""
        print(f"{back}{text}", end=end, file=sys.stderr, flush=True)
