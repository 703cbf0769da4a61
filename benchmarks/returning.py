"""Functions that return arrays and are called four times a step: the first gradient, and one of the next.

`python -m benchmarks.returning KERNEL` is the process in which one is measured, with a cache of its own.
"""
from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np

import s2sad
from benchmarks.kernels.cases import field
from benchmarks.kernels.returning import KERNELS
from benchmarks.tables import Table, seconds


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """One line for each kernel."""
    title = "Runge-Kutta, a field of 32 x 32 x 2, 20 steps, under Numba"
    table = Table(title, ("right-hand side", "first gradient", "next"))
    for name in KERNELS:
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-m", "benchmarks.returning", name], check=True, text=True,
                                  env={**os.environ, "S2SAD_CACHE_DIR": folder}, stdout=subprocess.PIPE,
                                  cwd=Path(__file__).resolve().parent.parent)
        first, later = json.loads(done.stdout.splitlines()[-1])
        table.rows.append((name, f"{first:.1f} s", seconds(later)))
    return [table]


def main(name: str) -> None:
    """Prints the seconds of the first gradient and the median of the next."""
    gradient = s2sad.gradient(s2sad.differentiate(KERNELS[name], engine="numba"), wrt="p")
    taken: list[float] = []
    for _ in range(16):
        start = perf_counter()
        gradient(field(32), np.array([0.1, 1.0, 3.4]), 1e-3, 20)
        taken.append(perf_counter() - start)
    print(json.dumps([taken[0], median(taken[1:])]))


if __name__ == "__main__":
    main(sys.argv[1])
