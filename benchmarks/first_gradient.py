"""Time to the first gradient of the Brusselator in a process of its own, from a cold and from a warm cache.

`python -m benchmarks.first_gradient` is that process: it prints what took how long as JSON.
"""
from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.tables import Table, verdict

TARGETS = {"cold": 6.0, "warm": 1.5}
STEPS = {"s2sad.read": "load", "s2sad.pipeline": "derive", "s2sad.run.compiled": "prepare"}
WORDS = {"python": "Python starts, ends", "import": "import numpy, s2sad", "numba": "import numba",
         "s2sad.read": "read", "s2sad.pipeline": "derive", "s2sad.run.compiled": "compile or load",
         "rest": "first runs, the rest"}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One column for each cache; the median of several processes when warm."""
    with tempfile.TemporaryDirectory() as folder:
        cold = _process(folder)
        warm = sorted((_process(folder) for _ in range(1 if quick else 5)), key=lambda found: found["total"])
    found = {"cold": cold, "warm": warm[len(warm) // 2]}
    table = Table("First gradient (vjp) of the Brusselator, interpreter's start included", ("", "cold", "warm"))
    for key, words in WORDS.items():
        table.rows.append((words, *(f"{found[c][key]:.2f} s" for c in found)))
    table.rows.append(("total", *(f"{found[c]['total']:.2f} s" for c in found)))
    table.rows.append(("target", *(f"{TARGETS[c]:g} s" for c in found)))
    table.rows.append(("", *(verdict(found[c]["total"], TARGETS[c]) for c in found)))
    for name, taken in cold["functions"]:
        table.notes.append(f"Numba, cold: {name} {taken:.2f} s (with what it calls)")
    return [table]


def _process(folder: str) -> dict[str, Any]:
    environment = {**os.environ, "S2SAD_CACHE_DIR": folder}
    start = perf_counter()
    done = subprocess.run([sys.executable, "-m", "benchmarks.first_gradient"], env=environment, check=True,
                          stdout=subprocess.PIPE, text=True, cwd=Path(__file__).resolve().parent.parent)
    total = perf_counter() - start
    found = json.loads(done.stdout.splitlines()[-1])
    return found | {"total": total, "python": total - found.pop("inside")}


def main() -> None:
    """Takes a gradient and prints the seconds of each step."""
    start = perf_counter()
    numpy = importlib.import_module("numpy")
    s2sad = importlib.import_module("s2sad")
    drivers = importlib.import_module("s2sad.drivers")
    imported = perf_counter()
    importlib.import_module("numba")
    with_numba = perf_counter()
    events = importlib.import_module("numba.core.event")
    recorder = events.RecordingListener()
    events.register("numba:compile", recorder)
    clocks = {module: _clocked(module, name) for module, name in STEPS.items()}
    brusselator = importlib.import_module("benchmarks.kernels.brusselator").brusselator
    field = importlib.import_module("benchmarks.kernels.cases").field
    arguments = numpy.zeros((32, 32, 2)), field(32), numpy.array([3.4, 1.0, 10.0, 1.0 / 32]), 1.2
    before = perf_counter()
    drivers.vjp(s2sad.differentiate(brusselator), arguments, {"du": numpy.ones((32, 32, 2))})
    after = perf_counter()
    steps = {module: clock[0] for module, clock in clocks.items()}
    print(json.dumps({**steps, "import": imported - start, "numba": with_numba - imported,
                      "rest": after - before - sum(steps.values()), "inside": after - start,
                      "functions": _compiled(recorder)}))


def _clocked(module: str, name: str) -> list[float]:
    """Replaces a function, wherever s2sad has imported it by name, by one that adds up its seconds."""
    function: Callable[..., Any] = getattr(importlib.import_module(module), name)
    seconds = [0.0]

    def timed(*args: Any, **keywords: Any) -> Any:
        start = perf_counter()
        try:
            return function(*args, **keywords)
        finally:
            seconds[0] += perf_counter() - start

    importlib.import_module("s2sad.api")
    for title, found in list(sys.modules.items()):
        if title.startswith("s2sad") and vars(found).get(name) is function:
            setattr(found, name, timed)
    return seconds


def _compiled(recorder: Any) -> list[tuple[str, float]]:
    """Numba's functions and their seconds, the longest first."""
    begun: dict[str, float] = {}
    taken: dict[str, float] = {}
    for at, event in recorder.buffer:
        name = event.data["dispatcher"].py_func.__qualname__
        if event.is_start:
            begun[name] = at
        elif name in begun:
            taken[name] = taken.get(name, 0.0) + at - begun.pop(name)
    return sorted(((name, round(t, 3)) for name, t in taken.items() if t > 0.01), key=lambda pair: -pair[1])


if __name__ == "__main__":
    main()
