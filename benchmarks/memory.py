"""Peak memory of an adjoint against what it may need: the primal's arrays, their shadows, and the recorded values.

Measured in a process of its own, from the system's high-water mark of resident memory (Linux), at sizes at which the
arrays are far larger than what the allocator keeps for itself. `python -m benchmarks.memory KERNEL` is that process.
"""
from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import s2sad
from benchmarks.calls import adjoint_arguments, differentiated
from benchmarks.kernels.cases import CASES, field
from benchmarks.tables import Table, verdict

MIB = 2.0 ** 20
STATUS = Path("/proc/self/status")
ALLOWANCE = 1.02  # pages that are not full, the allocator's own bookkeeping


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each kernel: the growth of memory during a call, its arguments included, against what is allowed."""
    table = Table("Peak memory of the adjoint, MiB",
                  ("kernel", "arguments", "local", "recorded", "allowed", "peak", ""))
    if not STATUS.exists():
        table.notes.append("needs Linux's /proc/self/status")
        return [table]
    for name in SIZES:
        done = subprocess.run([sys.executable, "-m", "benchmarks.memory", name], check=True, stdout=subprocess.PIPE,
                              text=True, cwd=Path(__file__).resolve().parent.parent)
        found = json.loads(done.stdout.splitlines()[-1])
        allowed = found["arguments"] + found["local"] + found["recorded"]
        table.rows.append((name, *(f"{found[k]:.1f}" for k in ("arguments", "local", "recorded")), f"{allowed:.1f}",
                           f"{found['peak']:.1f}", verdict(found["peak"], ALLOWANCE * allowed)))
    table.notes = ["arguments: arrays and their shadows; local: the kernel's own arrays and all shadows made inside;",
                   "recorded: the bytes that explain states; 2 % more are allowed for pages"]
    return [table]


def _integrate() -> tuple[tuple[Any, ...], float]:
    n, steps = 256, 100
    u = field(n)
    return (u, np.array([3.4, 1.0, 10.0, 1.0 / n]), 1e-7, steps), 3 * u.nbytes


def _advect() -> tuple[tuple[Any, ...], float]:
    n, steps = 100_000, 100
    u = np.sin(np.linspace(0.0, 6.0, n))
    return (u, 0.4, steps), 0.0


def _nbody() -> tuple[tuple[Any, ...], float]:
    n, steps = 1000, 1000
    random = np.random.default_rng(7)
    position = random.standard_normal((n, 3))
    arrays = position, 0.1 * random.standard_normal((n, 3)), np.zeros((n, 3)), 0.5 + random.random(n)
    return (*arrays, 0.01, steps, 0.1), 2 * position.nbytes


SIZES: dict[str, Callable[[], tuple[tuple[Any, ...], float]]] = {
    "integrate": _integrate, "advect": _advect, "nbody": _nbody}


def main(name: str) -> None:
    """Calls the adjoint once and prints MiB; compiled, and run with few steps, before."""
    case = CASES[name]
    small = adjoint_arguments(case, case.arguments("small"))
    f = differentiated(case)
    f.compiled("adjoint", *small)(*small)
    arguments, local = SIZES[name]()
    recorded = sum(stack.bytes or 0 for found in s2sad.explain(f, *arguments).functions for stack in found.recorded)
    shadowed = adjoint_arguments(case, arguments)
    del arguments
    given = sum(a.nbytes for a in shadowed if isinstance(a, np.ndarray))
    adjoint = f.compiled("adjoint", *shadowed)
    before = resident("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")  # the high-water mark starts anew
    adjoint(*shadowed)
    peak = resident("VmHWM") - before
    print(json.dumps({"arguments": given / MIB, "local": local / MIB, "recorded": recorded / MIB,
                      "peak": (peak + given) / MIB}))


def resident(what: str) -> float:
    """Bytes of this process by the system's count."""
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(what))
    return 1024.0 * float(line.split()[1])


if __name__ == "__main__":
    main(sys.argv[1])
