"""Loops that keep snapshots: the memory and the time of a gradient against what the count of steps predicts.

Each in a process of its own: `python -m benchmarks.snapshots KERNEL STEPS SNAPSHOTS [disk]`. The prediction is the
number of forward steps times the time of one, and for each step that of one in an adjoint that records, both taken over
few steps.
"""
from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import s2sad
from benchmarks.kernels import arrays
from benchmarks.kernels.brusselator import brusselator, integrate
from benchmarks.kernels.cases import ARRAYS, field
from benchmarks.memory import MIB, STATUS, resident
from benchmarks.tables import Table, verdict

FEW, ROUNDS = 500, 20           # steps of which the times of one are taken, and how often
MOST = 1.1          # of the predicted time
ROWS = (("integrate", 1_000_000, 100, ""), ("integrate_until", 1_000_000, 100, ""),
        ("integrate_until", 1_000_000, 10_000, "disk"), ("glacier", 10_000, 50, ""), ("lattice", 10_000, 50, ""))


def integrate_until(u, p, dt, end):
    """`integrate` up to a time; half the squared norm."""
    du = np.empty_like(u)
    t = 0.0
    while t < end:
        brusselator(du, u, p, t)
        u += dt * du
        t += dt
    return 0.5 * np.sum(u ** 2)


WHILE = f"line {integrate_until.__code__.co_firstlineno + 4}"
KERNELS: dict[str, tuple[Callable[..., Any], str, str]] = {     # the kernel, its loop, with respect to what
    "integrate": (integrate, "s", "u"), "integrate_until": (integrate_until, WHILE, "u"),
    "glacier": (arrays.glacier, "_", "thickness"), "lattice": (arrays.lattice, "_", "f")}


def given(name: str, steps: int) -> tuple[Any, ...]:
    """Arguments of a kernel for so many steps."""
    if name.startswith("integrate"):
        u, dt = field(32), 1e-5
        last = steps if name == "integrate" else (steps - 0.5) * dt
        return u, np.array([3.4, 1.0, 0.002, 1.0 / 32]), dt, last
    case = next(c for c in ARRAYS if c.name == name)
    *arguments, _ = case.arguments(48 if name == "glacier" else 24)
    if name == "glacier":
        arguments[-1] = 1e-4    # years a step
    return (*arguments, steps)


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each kernel."""
    return [table(measured_rows(quick))] if STATUS.exists() else []


def measured_rows(quick: bool = False) -> list[dict[str, Any]]:
    """What is found of each of `ROWS`, in fewer steps if `quick`."""
    found, root = [], Path(__file__).resolve().parent.parent
    own = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}
    for name, most, snapshots, where in ROWS:
        steps = most // 20 if quick else most
        done = subprocess.run([sys.executable, "-m", "benchmarks.snapshots", name, str(steps), str(snapshots), where],
                              check=True, stdout=subprocess.PIPE, text=True, cwd=root, env=own)
        found.append({"kernel": f"{name}{', on disk' if where else ''}", "steps": steps, "snapshots": snapshots,
                      **json.loads(done.stdout.splitlines()[-1])})
    return found


def table(rows: list[dict[str, Any]]) -> Table:
    made = Table("Gradients of long loops that keep snapshots", (
        "kernel", "steps", "snapshots", "forward runs", "kept, MiB", "peak, MiB", "process, MiB", "of its own, MiB",
        "time, s", "predicted, s", ""))
    for row in rows:
        made.rows.append((row["kernel"], f"{row['steps']:,}", f"{row['snapshots']:,}",
                          f"{row['runs'] / row['steps']:.2f} a step",
                          *(f"{row[k]:.1f}" for k in ("kept", "peak", "process", "own")), f"{row['time']:.2f}",
                          f"{row['predicted']:.2f}", verdict(row["time"], MOST * row["predicted"])))
    made.notes = ["forward runs: of steps, without the one in each step's adjoint; kept: what explain states;",
                  "peak: what the gradient adds to the memory of the process, which has the compilers in it and the",
                  "pages of files that it has mapped; of its own: without these, at the end;",
                  f"predicted: from the times of one step; at most {MOST} times that"]
    return made


def main(name: str, steps: int, snapshots: int, where: str = "") -> None:
    """Takes one gradient and prints seconds and MiB; compiled, and run with few steps, before."""
    with tempfile.TemporaryDirectory(prefix="snapshots-") as folder:
        print(json.dumps(measured(name, steps, s2sad.Snapshots(snapshots, on_disk=folder if where else None))))


def measured(name: str, steps: int, chosen: s2sad.Snapshots) -> dict[str, float]:
    kernel, loop, wrt = KERNELS[name]
    kept = s2sad.differentiate(kernel, engine="numba", checkpoint={loop: chosen})
    plain = s2sad.differentiate(kernel, engine="numba")
    few, many = given(name, FEW), given(name, steps)
    ways: list[Callable[..., Any]] = [lambda f, a: f.primal(*map(np.copy, a[:1]), *a[1:]), gradient(wrt)]
    times = [[timed(way, plain, few) for _ in range(ROUNDS)] for way in ways]
    timed(ways[1], kept, few)
    told = s2sad.explain(kept, *many)
    before = resident("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")
    taken = timed(ways[1], kept, many)
    peak, own = resident("VmHWM"), resident("RssAnon")
    forward, recorded = (statistics.median([*found[1:], *(timed(way, plain, few) for _ in range(ROUNDS))]) / FEW
                         for way, found in zip(ways, times))     # of the machine as it is while that runs
    loop_runs = kept.adjoint.memory(*many).loops[0]
    assert loop_runs.runs is not None
    runs = loop_runs.runs - (steps if loop_runs.in_adjoint else 0)
    rows = sum(stack.bytes or 0 for found in told.functions for stack in found.recorded if "snapshots" in stack.name)
    return {"runs": runs, "kept": rows / MIB, "peak": (peak - before) / MIB, "process": peak / MIB, "own": own / MIB,
            "time": taken, "predicted": runs * forward + steps * recorded}


def gradient(wrt: str) -> Callable[[Any, tuple[Any, ...]], Any]:
    """The gradient of half the squared norm, or of the array that a kernel writes, weighted by ones."""
    def taken(f: Any, arguments: tuple[Any, ...]) -> Any:
        output = "return" if wrt == "u" else wrt
        return s2sad.vjp(f, arguments, {output: 1.0 if wrt == "u" else np.ones_like(arguments[0])}, wrt=wrt)
    return taken


def timed(way: Callable[..., Any], f: Any, arguments: tuple[Any, ...]) -> float:
    """The seconds of a call."""
    start = time.perf_counter()
    way(f, arguments)
    return time.perf_counter() - start


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), *sys.argv[4:])
