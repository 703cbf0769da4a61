"""Time to the first gradient in a process of its own, from a cold and from a warm cache.

`python -m benchmarks.first_gradient KERNEL` is that process: it prints what took how long as JSON. With a warm cache it
does not load the compiler. What Numba and NumPy take to be imported is the floor.
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

TARGETS = {"brusselator": {"cold": 6.0, "warm": 0.8}, "shallow_water": {"cold": 15.0, "warm": 1.5}}
STEPS = {"program": "read", "summary": "summarize", "flat_program": "take structures apart", "derived": "derive"}
WORDS = {"python": "Python starts, ends", "import": "import numpy, s2sad", "numba": "import numba",
         "compiler": "import the compiler", **STEPS, "prepare": "compile or load", "rest": "first runs, the rest"}


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One table a kernel, one column for each cache; the median of several processes when warm."""
    return [_table(kernel, quick) for kernel in TARGETS]


def _table(kernel: str, quick: bool) -> Table:
    with tempfile.TemporaryDirectory() as folder:
        cold = _process(kernel, folder, "clocked")
        warm = sorted((_process(kernel, folder) for _ in range(1 if quick else 5)), key=lambda found: found["total"])
    found = {"cold": cold, "warm": warm[len(warm) // 2]}
    table = Table(f"First gradient of {kernel}, interpreter's start included", ("", "cold", "warm"))
    for key, words in WORDS.items():
        table.rows.append((words, *(f"{found[c].get(key, 0.0):.2f} s" for c in found)))
    table.rows.append(("total", *(f"{found[c]['total']:.2f} s" for c in found)))
    table.rows.append(("processor time", *(f"{found[c]['processor']:.2f} s" for c in found)))
    table.rows.append(("target", *(f"{TARGETS[kernel][c]:g} s" for c in found)))
    table.rows.append(("", *(verdict(found[c]["total"], TARGETS[kernel][c]) for c in found)))
    table.notes.append(f"the compiler is {'' if found['warm']['loaded'] else 'not '}loaded from a warm cache")
    for name, taken in cold["functions"]:
        table.notes.append(f"Numba, cold: {name} {taken:.2f} s (with what it calls)")
    return table


def _process(kernel: str, folder: str, *options: str) -> dict[str, Any]:
    environment = {**os.environ, "S2SAD_CACHE_DIR": folder}
    start, before = perf_counter(), os.times()
    done = subprocess.run([sys.executable, "-m", "benchmarks.first_gradient", kernel, *options], env=environment,
                          check=True, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).resolve().parent.parent)
    total, after = perf_counter() - start, os.times()
    processor = after.children_user + after.children_system - before.children_user - before.children_system
    found = json.loads(done.stdout.splitlines()[-1])
    return found | {"total": total, "processor": processor, "python": total - found.pop("inside")}


def main(kernel: str, clocked: bool) -> None:
    """Takes a gradient and prints the seconds of each step."""
    start = perf_counter()
    numpy = importlib.import_module("numpy")
    s2sad = importlib.import_module("s2sad")
    importlib.import_module("s2sad.interface.drivers")
    imported = perf_counter()
    importlib.import_module("numba")
    with_numba = perf_counter()
    events = importlib.import_module("numba.core.event")
    recorder = events.RecordingListener()
    events.register("numba:compile", recorder)
    clocks = {name: _clocked("s2sad.dispatch.compiler", name) for name in STEPS} if clocked else {}
    with_compiler = perf_counter()
    clocks["prepare"] = _clocked("s2sad.run.compiled", "prepare")
    call = _call(kernel, numpy, s2sad)
    before = perf_counter()
    call()
    after = perf_counter()
    steps = {name: clock[0] for name, clock in clocks.items()}
    print(json.dumps({**steps, "import": imported - start, "numba": with_numba - imported,
                      "compiler": with_compiler - with_numba, "loaded": "s2sad.pipeline" in sys.modules,
                      "rest": after - before - sum(steps.values()), "inside": after - start,
                      "functions": _compiled(recorder)}))


def _call(kernel: str, numpy: Any, s2sad: Any) -> Callable[[], Any]:
    module = importlib.import_module(f"benchmarks.kernels.{kernel}")
    if kernel == "shallow_water":
        gradient = s2sad.gradient(module.misfit, wrt="h0")
        return lambda: gradient(numpy.ones((8, 8)), module.Params(), numpy.zeros((8, 8)), 3)
    rng = numpy.random.default_rng(0)
    arguments = numpy.zeros((32, 32, 2)), rng.random((32, 32, 2)), numpy.array([3.4, 1.0, 10.0, 1.0 / 32]), 1.2
    return lambda: s2sad.vjp(s2sad.differentiate(module.brusselator), arguments, {"du": numpy.ones((32, 32, 2))})


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
    main(sys.argv[1], "clocked" in sys.argv)
