"""`python -m benchmarks.peers.worker ADAPTER` answers requests, a line of JSON each: one variant of one tool.

    {"do": "prepare", "variant": ..., "kernel": ..., "size": ..., "file": ...}
                                        -> {"seconds": ..., "since": ..., "lines": [..., ...]}
    {"do": "time", "seconds": ...}      -> {"times": [...]}
    {"do": "memory"}                    -> {"bytes": ...}
    {"do": "curve", "files": [...]}     -> {"steps": [...]}

What a tool cannot do is answered {"unsupported": why}, what goes wrong {"failed": what}. Gradients go through files.
"""
from __future__ import annotations

import ctypes
import gc
import importlib
import json
import os
import sys
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.peers.lines import changed
from benchmarks.peers.problems import Problem, Run, Unsupported

STATUS = Path("/proc/self/status")
SHORT = 1e-4    # seconds: what takes less is repeated so often


class Worker:
    """One variant of a tool with the gradient that was prepared last."""

    def __init__(self, adapter: str) -> None:
        self.adapter = importlib.import_module(f"benchmarks.peers.{adapter}")
        self.run: Run | None = None
        self.request: dict[str, Any] = {}

    def prepare(self, request: dict[str, Any]) -> dict[str, Any]:
        """Compiles and computes the gradient once, which is stored."""
        start, self.request, self.run = process_time(), request, None
        self.problem = Problem.of(request["kernel"], request["size"])
        self.run = self.adapter.prepare(request["variant"], request["kernel"], self.problem)
        stored(request["file"], self.run)
        kernel = self.problem.case.function
        version = getattr(self.adapter, "KERNELS", {}).get(request["kernel"], kernel)
        now = process_time()    # since the process was started
        return {"seconds": now - start, "since": now, "lines": changed(kernel, version)}

    def time(self, request: dict[str, Any]) -> dict[str, Any]:
        """Times of calls for so many seconds, at least one, after one that is not counted where it is short.

        It is the processor's time, which does not count what else the machine does meanwhile. Reading it takes a part
        of a microsecond: what is short is repeated.
        """
        assert self.run is not None
        call, times = self.run.call, []
        gc.collect()
        gc.disable()
        start = process_time()
        call()
        first = process_time() - start
        if first > request["seconds"]:
            times.append(first)
        repeats = range(max(1, int(SHORT / max(first, 1e-9))))
        while not times or process_time() - start < request["seconds"]:
            before = process_time()
            for _ in repeats:
                call()
            times.append((process_time() - before) / len(repeats))
        gc.enable()
        return {"times": times}

    def memory(self, request: dict[str, Any]) -> dict[str, Any]:
        """The growth of resident memory in a call, from memory that was given back to the system before."""
        assert self.run is not None
        if not STATUS.exists():
            raise Unsupported("needs Linux's /proc/self/status")
        gc.collect()
        if hasattr(ctypes.CDLL(None), "malloc_trim"):
            ctypes.CDLL(None).malloc_trim(0)
        before = resident("VmRSS")
        Path("/proc/self/clear_refs").write_text("5")     # the high-water mark starts anew
        found = self.run.call()
        peak = resident("VmHWM") - before
        del found
        return {"bytes": peak + self.run.held}

    def curve(self, request: dict[str, Any]) -> dict[str, Any]:
        """The gradients with each of the steps of a difference."""
        steps = self.adapter.STEPS[self.request["variant"]]
        for step, file in zip(steps, request["files"]):
            stored(file, self.adapter.prepare(self.request["variant"], self.request["kernel"], self.problem, step))
        return {"steps": steps}


def stored(file: str, run: Run) -> None:
    """Writes the gradients of a run."""
    np.savez(file, *(np.asarray(g) for g in run.gradients(run.call())))


def resident(what: str) -> float:
    """Bytes of resident memory, now (VmRSS) or at most (VmHWM)."""
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(what))
    return 1024.0 * float(line.split()[1])


def answered(worker: Worker, request: dict[str, Any]) -> dict[str, Any]:
    """The answer to a request, whatever happens."""
    try:
        return getattr(worker, request["do"])(request)
    except Unsupported as why:
        return {"unsupported": str(why)}
    except Exception as problem:  # whatever a tool raises is a line of the document
        return {"failed": f"{type(problem).__name__}: {(str(problem).splitlines() or [''])[0][:120]}"}


def main(adapter: str) -> None:
    """Reads requests until there are no more; what tools print goes to the standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    worker = Worker(adapter)
    for line in sys.stdin:
        answers.write(json.dumps(answered(worker, json.loads(line))) + "\n")
        answers.flush()


if __name__ == "__main__":
    main(sys.argv[1])
