"""A worker from outside: it is started when first asked, and stopped when it takes too long; a crash is an answer."""
from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Any


class Process:
    """The process of one variant of a tool."""

    def __init__(self, adapter: str, environment: Mapping[str, str] | None = None) -> None:
        self.command = [sys.executable, "-m", "benchmarks.peers.worker", adapter]
        self.environment = {**os.environ, **(environment or {})}
        self.process: subprocess.Popen[bytes] | None = None

    def ask(self, request: dict[str, Any], seconds: float, every_core: bool = False) -> dict[str, Any]:
        """The answer, or {"failed": ...} where there is none within so many seconds or the process ended.

        What is timed runs on the core that this process has; `every_core` is for what may run beside others.
        """
        if self.process is None:
            self.process = subprocess.Popen(self.command, env=self.environment, stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True)
        assert self.process.stdin is not None and self.process.stdout is not None
        _allow(self.process.pid, every_core)
        try:
            self.process.stdin.write(json.dumps(request).encode() + b"\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            return self._ended()
        ready, _, _ = select.select([self.process.stdout], [], [], seconds)
        if not ready:
            self.stop()
            return {"failed": f"over {seconds:g} s"}
        line = self.process.stdout.readline()
        return json.loads(line) if line.endswith(b"\n") else self._ended()

    def stop(self) -> None:
        """Ends the process; it is started again when it is asked again."""
        if self.process is not None:
            if self.process.poll() is None:
                os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            self.process = None

    def _ended(self) -> dict[str, Any]:
        assert self.process is not None
        status = self.process.wait()
        self.process = None
        how = signal.Signals(-status).name if status < 0 else f"status {status}"
        return {"failed": f"its process ended with {how}"}


def _allow(process: int, every_core: bool) -> None:
    """Lets all threads of a process run on every core, or on those of this process, where the system can."""
    if not hasattr(os, "sched_setaffinity"):
        return
    cores = set(range(os.cpu_count() or 1)) if every_core else os.sched_getaffinity(0)
    with suppress(OSError):     # no /proc, a thread or the process has ended, a core is not ours
        for thread in os.listdir(f"/proc/{process}/task"):
            with suppress(OSError):
                os.sched_setaffinity(int(thread), cores)
