"""Files that the command is given, and Python in a process of its own."""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

KERNELS = Path(__file__).resolve().parents[2] / "benchmarks" / "kernels"
BRUSSELATOR = f"{KERNELS / 'brusselator.py'}:brusselator"
SCALE = "def scale(u, c):\n    for i in range(u.size):\n        u[i] = c * u[i]\n"


def run_python(*arguments, cwd=None):
    return subprocess.run([sys.executable, *arguments], check=False, capture_output=True, text=True, cwd=cwd)
